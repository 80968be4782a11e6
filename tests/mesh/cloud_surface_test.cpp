// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/cloud_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "mesh/test_meshes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/mesh/surface_samples.hpp"

namespace ostraka {
namespace {

double volume(const TriangleMesh& mesh) {
    double six = 0.0;
    for (const Triangle& t : mesh.triangles) {
        six += mesh.vertices[t[0]].cast<double>().dot(
            mesh.vertices[t[1]].cast<double>().cross(mesh.vertices[t[2]].cast<double>()));
    }
    return six / 6.0;
}

double spacing_of(const TriangleMesh& mesh, std::size_t count) {
    return std::sqrt(surface_area(mesh) / static_cast<double>(count));
}

// Random points of a mesh, `noise` spacings off in each coordinate, without normals.
PointCloud scan_of(const TriangleMesh& mesh, std::size_t count, double noise = 0.0) {
    PointCloud cloud;
    cloud.points = sample_uniformly(mesh, count, 3).points;
    Random random(4);
    const double deviation = noise * spacing_of(mesh, count);
    for (Vec3f& point : cloud.points) {
        const Vec3d off(random.normal(), random.normal(), random.normal());
        point += Vec3d(deviation * off).cast<float>();
    }
    return cloud;
}

struct Deviation {
    double mean = 0.0;        // from samples of one surface to the nearest of the other
    double worst = 0.0;       // the same, at most, but for one in a thousand
    double inside_out = 0.0;  // share of samples whose normal is against that of the nearest
};

Deviation deviation(const TriangleMesh& from, const TriangleMesh& to) {
    constexpr std::size_t kSamples = 20'000;
    const SurfaceSamples samples = sample_uniformly(from, kSamples, 1);
    const SurfaceSamples dense = sample_uniformly(to, 15 * kSamples, 2);
    const KdTree tree(dense.points);
    std::vector<double> distances;
    Deviation result;
    for (std::size_t i = 0; i < kSamples; ++i) {
        const Neighbor near = tree.nearest(samples.points[i]);
        distances.push_back(std::sqrt(double{near.squared_distance}));
        result.mean += distances.back() / kSamples;
        // On an edge neither normal is that of the other's face.
        if (samples.normals[i].dot(dense.normals[near.index]) < -0.5F) {
            result.inside_out += 1.0 / kSamples;
        }
    }
    std::sort(distances.begin(), distances.end());
    result.worst = distances[kSamples - kSamples / 1000];
    return result;
}

struct Bounds {
    double mean;   // spacings
    double worst;  // spacings
    double size;   // relative error of area and volume
};

void expect_rebuilt(const TriangleMesh& truth, std::size_t count, double noise,
                    const Bounds& bounds) {
    const double spacing = spacing_of(truth, count);
    const CloudSurface surface = rebuild_surface(scan_of(truth, count, noise));
    EXPECT_NEAR(surface.spacing, spacing, 0.15 * spacing);
    for (const Deviation& d : {deviation(surface.mesh, truth), deviation(truth, surface.mesh)}) {
        EXPECT_LT(d.mean, bounds.mean * spacing);
        EXPECT_LT(d.worst, bounds.worst * spacing);
        EXPECT_LT(d.inside_out, 0.002);
    }
    EXPECT_NEAR(surface_area(surface.mesh) / surface_area(truth), 1.0, bounds.size);
    EXPECT_NEAR(volume(surface.mesh) / volume(truth), 1.0, bounds.size);
}

TriangleMesh torus(double ring, double tube) {
    constexpr std::uint32_t kRing = 120;
    constexpr std::uint32_t kTube = 48;
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < kRing; ++i) {
        for (std::uint32_t j = 0; j < kTube; ++j) {
            const double a = 2 * kPi * i / kRing;
            const double b = 2 * kPi * j / kTube;
            const double r = ring + tube * std::cos(b);
            mesh.vertices.push_back(
                Vec3d(r * std::cos(a), r * std::sin(a), tube * std::sin(b)).cast<float>());
            const auto at = [](std::uint32_t u, std::uint32_t v) {
                return u % kRing * kTube + v % kTube;
            };
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

TEST(CloudSurface, OfASphereIsASphere) {
    const TriangleMesh sphere = test_meshes::sphere(10.0, 120);
    expect_rebuilt(sphere, 6000, 0.0, {0.15, 0.4, 0.01});
    // Closed: every edge has a triangle on either side.
    const CloudSurface surface = rebuild_surface(scan_of(sphere, 6000));
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (const Triangle& t : surface.mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            edges.push_back({t[k], t[(k + 1) % 3]});
        }
    }
    std::sort(edges.begin(), edges.end());
    for (const auto& edge : edges) {
        ASSERT_TRUE(std::binary_search(edges.begin(), edges.end(), std::array{edge[1], edge[0]}));
    }
}

TEST(CloudSurface, OfATorusIsATorus) {
    expect_rebuilt(torus(10.0, 4.0), 8000, 0.0, {0.15, 0.4, 0.02});
}

TEST(CloudSurface, OfABoxIsABox) {
    expect_rebuilt(test_meshes::box({10, 7, 5}), 8000, 0.0, {0.15, 0.8, 0.02});
}

TEST(CloudSurface, SmoothsNoise) {
    expect_rebuilt(test_meshes::sphere(10.0, 120), 6000, 0.5, {0.3, 1.0, 0.04});
    expect_rebuilt(test_meshes::box({10, 7, 5}), 8000, 0.5, {0.35, 1.3, 0.04});
}

TEST(CloudSurface, OfAThinPlateHasTwoSides) {
    const std::size_t count = 9000;  // three spacings thick
    expect_rebuilt(test_meshes::box({12, 8, 0.45F}), count, 0.0, {0.2, 1.0, 0.05});
}

TEST(CloudSurface, IsOpenWhereThereAreNoPointsAndDoesNotGrow) {
    const double radius = 10.0;
    PointCloud bowl;
    for (const Vec3f& point : scan_of(test_meshes::sphere(radius, 120), 8000).points) {
        if (point.z() < 3.0F) bowl.points.push_back(point);
    }
    const CloudSurface surface = rebuild_surface(bowl);
    float top = -100.0F;
    for (const Triangle& t : surface.mesh.triangles) {
        for (const std::uint32_t v : t) top = std::max(top, surface.mesh.vertices[v].z());
    }
    EXPECT_LT(top, 3.0 + 2.5 * surface.spacing);
    // Archimedes: as much as the cylinder around it.
    EXPECT_NEAR(surface_area(surface.mesh), 2 * kPi * radius * (radius + 3.0),
                0.02 * surface_area(surface.mesh));
}

TEST(CloudSurface, ClosesTheGapsOfUnevenPoints) {
    const TriangleMesh sphere = test_meshes::sphere(10.0, 120);
    PointCloud cloud;  // four times as dense on one half
    Random random(8);
    for (const Vec3f& point : scan_of(sphere, 12'000).points) {
        if (point.x() > 0.0F || random.below(4) == 0) cloud.points.push_back(point);
    }
    const CloudSurface surface = rebuild_surface(cloud);
    EXPECT_NEAR(surface_area(surface.mesh) / surface_area(sphere), 1.0, 0.02);
    EXPECT_NEAR(volume(surface.mesh) / volume(sphere), 1.0, 0.02);
    EXPECT_LT(deviation(sphere, surface.mesh).worst, surface.spacing);
}

TEST(CloudSurface, OfMoreNoiseThanSpacingIsCoarserButWhole) {
    const TriangleMesh sphere = test_meshes::sphere(10.0, 120);
    const CloudSurface surface = rebuild_surface(scan_of(sphere, 40'000, 2.0));
    EXPECT_GT(surface.spacing, 1.3 * spacing_of(sphere, 40'000));
    EXPECT_NEAR(surface_area(surface.mesh) / surface_area(sphere), 1.0, 0.1);
    EXPECT_NEAR(volume(surface.mesh) / volume(sphere), 1.0, 0.08);
}

TEST(CloudSurface, IsTheSameBytesForAnyNumberOfThreads) {
    const PointCloud cloud = scan_of(test_meshes::lopsided(), 5000, 0.2);
    set_thread_count(1);
    const TriangleMesh one = rebuild_surface(cloud).mesh;
    set_thread_count(4);
    const TriangleMesh four = rebuild_surface(cloud).mesh;
    set_thread_count(0);
    ASSERT_EQ(one.vertices.size(), four.vertices.size());
    EXPECT_EQ(
        std::memcmp(one.vertices.data(), four.vertices.data(), one.vertices.size() * sizeof(Vec3f)),
        0);
    EXPECT_EQ(one.triangles, four.triangles);
}

TEST(CloudSurface, StandsInvalidRepeatedAndStrayPoints) {
    const TriangleMesh sphere = test_meshes::sphere(10.0, 120);
    PointCloud cloud = scan_of(sphere, 6000);
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t i = 0; i < 500; ++i) {
        cloud.points.push_back(cloud.points[i]);
        cloud.points.emplace_back(kNaN, 0.0F, std::numeric_limits<float>::infinity());
    }
    cloud.points.emplace_back(60.0F, 0.0F, 0.0F);
    cloud.points.emplace_back(0.0F, 9000.0F, 0.0F);
    const CloudSurface surface = rebuild_surface(cloud);
    EXPECT_EQ(surface.points, 6000U);
    EXPECT_NEAR(surface_area(surface.mesh) / surface_area(sphere), 1.0, 0.01);
}

TEST(CloudSurface, TurnsGivenNormalsThatDisagree) {
    const TriangleMesh sphere = test_meshes::sphere(10.0, 120);
    const SurfaceSamples samples = sample_uniformly(sphere, 6000);
    PointCloud cloud;
    cloud.points = samples.points;
    cloud.normals = samples.normals;
    for (std::size_t i = 0; i < cloud.size(); i += 2) cloud.normals[i] *= -3.0F;
    EXPECT_NEAR(volume(rebuild_surface(cloud).mesh) / volume(sphere), 1.0, 0.01);
}

TEST(CloudSurface, SaysWhatIsNoSurface) {
    EXPECT_THROW(rebuild_surface({}), InvalidInput);
    PointCloud few;
    few.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    EXPECT_THROW(rebuild_surface(few), InvalidInput);
    PointCloud same;
    same.points.assign(1000, Vec3f(1, 2, 3));
    EXPECT_THROW(rebuild_surface(same), InvalidInput);
    PointCloud plane;
    PointCloud line;
    Random random(5);
    for (int i = 0; i < 3000; ++i) {
        const auto x = static_cast<float>(random.uniform());
        plane.points.emplace_back(x, static_cast<float>(random.uniform()), 5.0F);
        line.points.emplace_back(x, 2 * x, 5.0F);
    }
    EXPECT_THROW(rebuild_surface(plane), InvalidInput);
    EXPECT_THROW(rebuild_surface(line), InvalidInput);
    PointCloud fog;
    for (int i = 0; i < 3000; ++i) fog.points.push_back(random.direction().cast<float>());
    EXPECT_THROW(rebuild_surface(fog, {.voxel = 0.0}), InvalidInput);
    fog.points.push_back(Vec3f::Constant(1e38F));
    EXPECT_NO_THROW(rebuild_surface(fog));
}

}  // namespace
}  // namespace ostraka
