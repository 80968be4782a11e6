// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/contour.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"
#include "simulation/closed_mesh.hpp"

namespace ostraka {
namespace {

TriangleMesh mesh_of(const Solid& solid, int resolution = 64) {
    return contour(solid, {.resolution = resolution});
}

TEST(Contour, ASphereHasItsVolumeAndAreaAndConvergesQuadratically) {
    const double volume = 4.0 / 3.0 * kPi * 1000.0;
    const double area = 4.0 * kPi * 100.0;
    const auto coarse = mesh_of(sphere(10.0), 32);
    const auto fine = mesh_of(sphere(10.0), 64);
    const double coarse_error = std::abs(examine(coarse).volume / volume - 1.0);
    const double fine_error = std::abs(examine(fine).volume / volume - 1.0);
    EXPECT_LT(coarse_error, 5e-3);
    EXPECT_LT(fine_error, 0.35 * coarse_error);
    EXPECT_NEAR(surface_area(fine) / area, 1.0, 2e-3);
    EXPECT_EQ(examine(fine).genus(), 0);
    for (const Vec3f& v : fine.vertices) EXPECT_NEAR(v.norm(), 10.0, 2e-3);
}

TEST(Contour, ATorusHasItsVolumeAreaAndGenus) {
    const auto mesh = mesh_of(rotated(torus(10.0, 4.0), {1, 2, 3}, 0.7), 80);
    const ClosedMeshReport report = examine(mesh);
    EXPECT_TRUE(report.manifold);
    EXPECT_EQ(report.genus(), 1);
    EXPECT_NEAR(report.volume / (2.0 * kPi * kPi * 10.0 * 16.0), 1.0, 4e-3);
    EXPECT_NEAR(surface_area(mesh) / (4.0 * kPi * kPi * 10.0 * 4.0), 1.0, 4e-3);
}

TEST(Contour, ABoxIsExactWithItsSharpEdges) {
    const Solid solid = box({10.0, 14.0, 20.0});
    const auto mesh = mesh_of(solid, 48);
    EXPECT_NEAR(examine(mesh).volume, 2800.0, 0.01);
    EXPECT_NEAR(surface_area(mesh), 2.0 * (140.0 + 200.0 + 280.0), 0.01);
    for (const Vec3f& v : mesh.vertices) {
        EXPECT_NEAR(solid.distance(v.cast<double>()), 0.0, 1e-4);
    }
}

TEST(Contour, ATurnedBoxKeepsItsCornersAndEdges) {
    const Vec3d axis(3, 1, 2);
    const Solid solid = rotated(box({10.0, 14.0, 20.0}), axis, 0.8);
    const auto mesh = mesh_of(solid, 64);
    EXPECT_TRUE(examine(mesh).manifold);
    // Where a cell must clamp its vertex, an edge is cut by a small part of a cell.
    EXPECT_NEAR(examine(mesh).volume, 2800.0, 3.0);
    const Vec3d corner = Eigen::AngleAxisd(0.8, Eigen::Vector3d(axis).normalized()) *
                         Eigen::Vector3d(5.0, 7.0, 10.0);
    float nearest = 1e9F;
    for (const Vec3f& v : mesh.vertices) {
        nearest = std::min(nearest, (v - corner.cast<float>()).norm());
    }
    // A corner in a cell without crossings is cut off, by less than half a cell.
    EXPECT_LT(nearest, 0.5F * 20.0F / 64.0F);
}

TEST(Contour, ABoxWithAHoleHasVolumeAreaAndGenusOne) {
    const Solid solid = subtract(box({30.0, 30.0, 10.0}), cylinder(6.0, 50.0));
    const auto mesh = mesh_of(solid, 96);
    const ClosedMeshReport report = examine(mesh);
    EXPECT_EQ(report.genus(), 1);
    EXPECT_NEAR(report.volume / (9000.0 - kPi * 360.0), 1.0, 1e-3);
    const double area = 2.0 * (900.0 - kPi * 36.0) + 1200.0 + 2.0 * kPi * 60.0;
    EXPECT_NEAR(surface_area(mesh) / area, 1.0, 2e-3);
}

TEST(Contour, FacesLookTheWayTheGradientDoes) {
    const Solid solid = smooth_unite(sphere(8.0), moved(sphere(6.0), {9, 3, 0}), 4.0);
    const auto mesh = mesh_of(solid, 64);
    for (const Triangle& t : mesh.triangles) {
        const Vec3d normal = area_vector(mesh, t).normalized();
        const Vec3d middle =
            (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]).cast<double>() / 3.0;
        EXPECT_GT(normal.dot(solid.gradient(middle, 1e-4)), 0.97);
    }
}

// Balls that touch, cross and nearly touch, at random: every ambiguous cell comes up.
TEST(Contour, RandomClutterIsClosedAndManifold) {
    Random random(4);
    for (int trial = 0; trial < 6; ++trial) {
        std::vector<Solid> solids;
        for (int i = 0; i < 250; ++i) {
            const double x = random.uniform(-10.0, 10.0);
            const double y = random.uniform(-10.0, 10.0);
            const double z = random.uniform(-10.0, 10.0);
            const Solid shape = trial % 2 == 0 ? sphere(random.uniform(0.5, 1.2))
                                               : box(Vec3d::Constant(random.uniform(0.8, 2.0)));
            const Vec3d axis = random.direction();
            solids.push_back(moved(rotated(shape, axis, random.uniform(0.0, 3.0)), {x, y, z}));
        }
        Solid solid = unite(solids);
        if (trial >= 4) solid = subtract(sphere(9.0), solid);
        const ClosedMeshReport report = examine(mesh_of(solid, 24));
        EXPECT_TRUE(report.closed) << trial;
        EXPECT_TRUE(report.manifold) << trial;
        EXPECT_GT(report.volume, 0.0);
    }
}

TEST(Contour, IsTheSameForAnyNumberOfThreads) {
    const Solid solid = subtract(sphere(10.0), rotated(box({8, 8, 40}), {1, 1, 0}, 0.5));
    set_thread_count(1);
    const auto one = mesh_of(solid);
    set_thread_count(0);
    const auto all = mesh_of(solid);
    ASSERT_EQ(one.vertices.size(), all.vertices.size());
    EXPECT_EQ(one.triangles, all.triangles);
    EXPECT_EQ(
        std::memcmp(one.vertices.data(), all.vertices.data(), one.vertices.size() * sizeof(Vec3f)),
        0);
}

TEST(Contour, RejectsWhatItCannotContour) {
    EXPECT_THROW(mesh_of(half_space({0, 0, 1}, 0.0)), InvalidInput);
    const Solid apart = intersect(sphere(1.0), moved(sphere(1.0), {5, 0, 0}));
    EXPECT_THROW(mesh_of(apart), InvalidInput);
    EXPECT_THROW(mesh_of(sphere(1.0), 7), InvalidInput);
    EXPECT_THROW(mesh_of(sphere(1.0), 513), InvalidInput);
    EXPECT_THROW(contour(sphere(1.0), {.sharp_angle = 0.0}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
