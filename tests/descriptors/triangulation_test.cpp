// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/triangulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

Vec3d area_vector(const PointCloud& cloud, const IndexTriangle& t) {
    const Vec3d a = cloud.points[t[0]].cast<double>();
    return 0.5 *
           (cloud.points[t[1]].cast<double>() - a).cross(cloud.points[t[2]].cast<double>() - a);
}

double total_area(const PointCloud& cloud, const std::vector<IndexTriangle>& triangles) {
    double area = 0.0;
    for (const IndexTriangle& t : triangles) area += area_vector(cloud, t).norm();
    return area;
}

// The most triangles that share an edge.
std::size_t most_around_an_edge(const std::vector<IndexTriangle>& triangles) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> edges;
    std::size_t most = 0;
    for (const IndexTriangle& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            most = std::max(most, ++edges[std::minmax(t[k], t[(k + 1) % 3])]);
        }
    }
    return most;
}

PointCloud flat_grid(int size) {
    PointCloud cloud;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            cloud.points.emplace_back(static_cast<float>(x), static_cast<float>(y), 0.0F);
            cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
        }
    }
    cloud.viewpoint = Vec3f(0.0F, 0.0F, 100.0F);
    return cloud;
}

TEST(Triangulation, GridOfCocircularPointsIsCoveredOnce) {
    const PointCloud cloud = flat_grid(21);
    const auto triangles = triangulate(cloud);
    EXPECT_EQ(triangles.size(), 800U);
    EXPECT_NEAR(total_area(cloud, triangles), 400.0, 1e-6);
    EXPECT_LE(most_around_an_edge(triangles), 2U);
}

TEST(Triangulation, ScatteredPlaneIsCoveredOnce) {
    PointCloud cloud;
    Random random(4);
    for (int i = 0; i < 3'000; ++i) {
        cloud.points.emplace_back(random.uniform(), random.uniform(), 0.5);
        cloud.normals.emplace_back(0.0F, 0.0F, -1.0F);
    }
    const auto triangles = triangulate(cloud, {.longest_edge = 8.0F});
    // Stars reach for about 20 neighbors, which leaves holes where chance leaves gaps.
    EXPECT_GT(total_area(cloud, triangles), 0.8);
    EXPECT_LT(total_area(cloud, triangles), 1.0);
    EXPECT_LE(most_around_an_edge(triangles), 2U);
    for (const IndexTriangle& t : triangles) EXPECT_LT(area_vector(cloud, t).z(), 0.0);
}

TEST(Triangulation, CurvedSurfaceIsNearlyCovered) {
    const PointCloud cloud = shapes::cut_torus(6'000);
    const auto triangles = triangulate(cloud, {.longest_edge = 8.0F});
    // Points are spread evenly over the parameters, so the densest side sets no scale here: most of
    // the points must be corners of a full turn of triangles that look along their normals.
    EXPECT_GT(triangles.size(), 2 * cloud.size() * 9 / 10);
    EXPECT_LE(triangles.size(), 2 * cloud.size() * 21 / 20);
    for (const IndexTriangle& t : triangles) {
        EXPECT_GT(area_vector(cloud, t).dot(cloud.normals[t[0]].cast<double>()), 0.0);
    }
    std::set<IndexTriangle> unique;
    for (IndexTriangle t : triangles) {
        std::sort(t.begin(), t.end());
        unique.insert(t);
    }
    EXPECT_EQ(unique.size(), triangles.size());
}

TEST(Triangulation, NoEdgeIsTooLong) {
    PointCloud cloud = flat_grid(10);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (cloud.points[i].x() > 4.5F) cloud.points[i].x() += 20.0F;
    }
    const auto triangles = triangulate(cloud);
    EXPECT_NEAR(total_area(cloud, triangles), 2.0 * 4.0 * 9.0, 1e-6);
}

TEST(Triangulation, OrganizedCloudsUseTheirGridAndSkipHoles) {
    PointCloud cloud = flat_grid(10);
    cloud.width = 10;
    cloud.height = 10;
    cloud.points[55] = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
    const auto triangles = triangulate(cloud);
    // Four cells lose one corner each and keep one triangle.
    EXPECT_EQ(triangles.size(), 2U * 81U - 4U);
    for (const IndexTriangle& t : triangles) EXPECT_GT(area_vector(cloud, t).z(), 0.0);
}

TEST(Triangulation, OrganizedCloudsAreCutAtDepthSteps) {
    PointCloud cloud = flat_grid(10);
    cloud.width = 10;
    cloud.height = 10;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (i % 10 >= 5) cloud.points[i].z() -= 30.0F;
    }
    EXPECT_EQ(triangulate(cloud).size(), 2U * 2U * 4U * 9U);
}

TEST(Triangulation, ThreadCountChangesNothing) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(4'000);
    set_thread_count(1);
    const auto one = triangulate(cloud);
    set_thread_count(0);
    EXPECT_EQ(triangulate(cloud), one);
}

TEST(Triangulation, DegenerateCloudsGiveNoTriangles) {
    EXPECT_TRUE(triangulate({}).empty());
    PointCloud line;
    for (int i = 0; i < 50; ++i) line.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    line.normals.assign(50, Vec3f(0, 0, 1));
    EXPECT_TRUE(triangulate(line).empty());
    line.points.assign(50, Vec3f(1, 2, 3));
    EXPECT_TRUE(triangulate(line).empty());
    line.normals.clear();
    EXPECT_THROW(triangulate(line), InvalidInput);
}

}  // namespace
}  // namespace ostraka
