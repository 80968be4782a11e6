// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mesh/test_meshes.hpp"

namespace ostraka {
namespace {

TEST(Measure, ABoxHasItsDiagonalAsDiameter) {
    const MeshShape shape = measure(test_meshes::box({1, 2, 3}));
    const double half_diagonal = std::sqrt(14.0);
    EXPECT_NEAR(shape.diameter, 2.0 * half_diagonal, 1e-5);
    EXPECT_NEAR(shape.radius, half_diagonal, 0.01 * half_diagonal);
    EXPECT_LT(shape.center.norm(), 0.01 * half_diagonal);
    EXPECT_NEAR(std::abs(shape.axes(2, 0)), 1.0, 1e-9) << "longest first";
    EXPECT_NEAR(std::abs(shape.axes(1, 1)), 1.0, 1e-9);
    EXPECT_NEAR(shape.axes.determinant(), 1.0, 1e-9);
}

// The ball of an equilateral triangle is its circumscribed one: center and radius in closed form.
TEST(Measure, ATriangleHasItsCircumscribedBall) {
    TriangleMesh mesh;
    for (int k = 0; k < 3; ++k) {
        const double angle = 2.0 * kPi * k / 3.0;
        mesh.vertices.push_back(Vec3d(7 + std::cos(angle), 8 + std::sin(angle), 9).cast<float>());
    }
    mesh.triangles = {{0, 1, 2}};
    const MeshShape shape = measure(mesh);
    EXPECT_LT((shape.center - Vec3d(7, 8, 9)).norm(), 0.01);
    EXPECT_NEAR(shape.radius, 1.0, 0.01);
    EXPECT_NEAR(shape.diameter, std::sqrt(3.0), 1e-5);
}

TEST(Measure, AgreesWithAllPairsOfVertices) {
    const TriangleMesh mesh = test_meshes::lopsided(30);
    const MeshShape shape = measure(mesh);
    double diameter = 0.0;
    double radius = 0.0;
    for (const Vec3f& a : mesh.vertices) {
        radius = std::max(radius, (a.cast<double>() - shape.center).norm());
        for (const Vec3f& b : mesh.vertices) {
            diameter = std::max(diameter, (a - b).cast<double>().norm());
        }
    }
    EXPECT_LE(shape.diameter, diameter + 1e-5);
    EXPECT_GE(shape.diameter, 0.995 * diameter);
    EXPECT_NEAR(shape.radius, radius, 1e-9) << "every vertex is inside";
    // Jung: the smallest ball has a radius between 1/2 and sqrt(3/8) diameters.
    EXPECT_GE(shape.radius, 0.5 * diameter);
    EXPECT_LE(shape.radius, 1.01 * std::sqrt(3.0 / 8.0) * diameter);
}

TEST(Measure, TurnsWithTheMesh) {
    const TriangleMesh mesh = test_meshes::lopsided(24);
    const MeshShape before = measure(mesh);
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Pose pose = test_meshes::random_pose(seed, 20.0);
        const MeshShape after = measure(transformed(mesh, pose));
        EXPECT_NEAR(after.diameter, before.diameter, 1e-4 * before.diameter);
        EXPECT_NEAR(after.radius, before.radius, 1e-3 * before.radius);
        EXPECT_LT((after.center - pose * before.center).norm(), 2e-3 * before.radius);
        EXPECT_LT((after.axes - pose.linear() * before.axes).norm(), 1e-3);
    }
}

TEST(Measure, AxesDoNotDependOnTheTriangulation) {
    const MeshShape coarse = measure(test_meshes::lopsided(40));
    const MeshShape fine = measure(test_meshes::lopsided(80));
    EXPECT_LT((coarse.axes - fine.axes).norm(), 0.02);
    EXPECT_NEAR(coarse.diameter, fine.diameter, 0.01 * fine.diameter);
}

TEST(Measure, ScalesWithTheMesh) {
    const TriangleMesh mesh = test_meshes::lopsided(24);
    const MeshShape small = measure(mesh);
    const MeshShape large = measure(scaled(mesh, 1000.0));
    EXPECT_NEAR(large.diameter / small.diameter, 1000.0, 0.01);
    EXPECT_NEAR(large.radius / small.radius, 1000.0, 0.1);
    EXPECT_LT((large.axes - small.axes).norm(), 1e-4);
}

}  // namespace
}  // namespace ostraka
