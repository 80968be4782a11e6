// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/surface_samples.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mesh/test_meshes.hpp"

namespace ostraka {
namespace {

// The face of the box that the normal is exactly perpendicular to, if the point lies on it: 0 and 1
// for +x and -x, and so on; -1 if there is none.
int face_of(const Vec3f& point, const Vec3f& normal, const Vec3f& half) {
    if ((point.cwiseAbs() - half).maxCoeff() > 1e-5F) return -1;
    for (int face = 0; face < 6; ++face) {
        const float side = face % 2 == 0 ? 1.0F : -1.0F;
        const bool right_normal = normal == side * Vec3f(Vec3f::Unit(face / 2));
        if (right_normal && std::abs(point[face / 2] - side * half[face / 2]) < 1e-5F) return face;
    }
    return -1;
}

double nearest_gap(const std::vector<Vec3f>& points, std::size_t count) {
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            least = std::min(least, (points[i] - points[j]).cast<double>().norm());
        }
    }
    return least;
}

TEST(SampleUniformly, LiesOnTheSurfaceInProportionToArea) {
    const Vec3f half(1, 2, 3);
    const SurfaceSamples samples = sample_uniformly(test_meshes::box(half), 44'000, 1);
    ASSERT_EQ(samples.points.size(), 44'000U);
    ASSERT_EQ(samples.normals.size(), 44'000U);
    std::array<int, 6> counts{};
    for (std::size_t i = 0; i < samples.points.size(); ++i) {
        const int face = face_of(samples.points[i], samples.normals[i], half);
        ASSERT_GE(face, 0);
        ++counts.at(static_cast<std::size_t>(face));
    }
    // Areas 24, 24, 12, 12, 8, 8 of 88: 500 samples a unit of area.
    const std::array<int, 6> expected = {12'000, 12'000, 6'000, 6'000, 4'000, 4'000};
    for (std::size_t f = 0; f < 6; ++f) {
        EXPECT_NEAR(counts[f], expected[f], 5.0 * std::sqrt(expected[f]));
    }
}

TEST(SampleUniformly, IsUniformInsideATriangle) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    const SurfaceSamples samples = sample_uniformly(mesh, 100'000, 2);
    Vec3d mean = Vec3d::Zero();
    double xx = 0.0;
    double xy = 0.0;
    for (const Vec3f& point : samples.points) {
        ASSERT_LE(point.x() + point.y(), 1.0F + 1e-6F);
        mean += point.cast<double>() / 1e5;
        xx += double{point.x()} * point.x() / 1e5;
        xy += double{point.x()} * point.y() / 1e5;
    }
    EXPECT_LT((mean - Vec3d(1, 1, 0) / 3.0).norm(), 4e-3);
    EXPECT_NEAR(xx, 1.0 / 6.0, 2e-3);
    EXPECT_NEAR(xy, 1.0 / 12.0, 1e-3);
}

TEST(SampleUniformly, NeverPicksATriangleWithoutArea) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}};
    mesh.triangles = {{3, 3, 3}, {0, 1, 2}, {3, 3, 3}};
    for (const Vec3f& point : sample_uniformly(mesh, 1000, 3).points) {
        ASSERT_LT(point.norm(), 1.001F);
    }
}

TEST(Samples, SameSeedSameSamples) {
    const TriangleMesh mesh = test_meshes::lopsided(20);
    EXPECT_EQ(sample_evenly(mesh, 100, 5).points, sample_evenly(mesh, 100, 5).points);
    EXPECT_NE(sample_evenly(mesh, 100, 5).points, sample_evenly(mesh, 100, 6).points);
    EXPECT_TRUE(sample_evenly(mesh, 0).points.empty());
    EXPECT_EQ(sample_evenly(mesh, 1).points.size(), 1U);
}

TEST(SampleEvenly, IsFarMoreEvenThanUniform) {
    const TriangleMesh mesh = test_meshes::sphere(1.0);
    const std::size_t count = 500;
    const SurfaceSamples even = sample_evenly(mesh, count, 1);
    ASSERT_EQ(even.points.size(), count);
    for (const Vec3f& point : even.points) ASSERT_NEAR(point.norm(), 1.0F, 2e-3F);
    // Hexagonal packing, the densest, would put the points this far apart.
    const double densest = std::sqrt(4.0 * kPi / static_cast<double>(count) * 2.0 / std::sqrt(3.0));
    EXPECT_GT(nearest_gap(even.points, count), 0.55 * densest);
    EXPECT_LT(nearest_gap(sample_uniformly(mesh, count, 1).points, count), 0.2 * densest);
}

TEST(SampleEvenly, EveryBeginningIsEven) {
    const SurfaceSamples even = sample_evenly(test_meshes::sphere(1.0), 400, 1);
    for (const std::size_t count : {10U, 50U, 100U, 200U}) {
        const double densest =
            std::sqrt(4.0 * kPi / static_cast<double>(count) * 2.0 / std::sqrt(3.0));
        EXPECT_GT(nearest_gap(even.points, count), 0.55 * densest) << count;
    }
}

}  // namespace
}  // namespace ostraka
