// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/height_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/base/random.hpp"
#include "ostraka/simulation/landing_surface.hpp"
#include "ostraka/simulation/parts.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Polygon = std::vector<Vec3d>;

// Sutherland and Hodgman: the part of a polygon where sign * (point[axis] - limit) >= 0.
Polygon clipped(const Polygon& polygon, int axis, double sign, double limit) {
    Polygon result;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3d& p = polygon[i];
        const Vec3d& q = polygon[(i + 1) % polygon.size()];
        const double a = sign * (p[axis] - limit);
        const double b = sign * (q[axis] - limit);
        if (a >= 0.0) result.push_back(p);
        if ((a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0)) {
            result.push_back(p + a / (a - b) * (q - p));
        }
    }
    return result;
}

struct Envelope {
    double low = kInfinity;
    double high = -kInfinity;
};

// What the surface reaches in a cell that is larger by `margin` on all sides: by clipping.
Envelope envelope(const std::vector<Polygon>& triangles, double x, double y, double side,
                  double margin) {
    Envelope result;
    for (const Polygon& triangle : triangles) {
        Polygon part = clipped(triangle, 0, 1.0, x - margin);
        part = clipped(part, 0, -1.0, x + side + margin);
        part = clipped(part, 1, 1.0, y - margin);
        part = clipped(part, 1, -1.0, y + side + margin);
        for (const Vec3d& point : part) {
            result.low = std::min(result.low, point.z());
            result.high = std::max(result.high, point.z());
        }
    }
    return result;
}

std::vector<Polygon> turned_triangles(const TriangleMesh& mesh, const Mat3d& R) {
    std::vector<Polygon> triangles;
    for (const Triangle& triangle : mesh.triangles) {
        Polygon polygon;
        for (const std::uint32_t v : triangle) {
            polygon.push_back(R * mesh.vertices[v].cast<double>());
        }
        triangles.push_back(polygon);
    }
    return triangles;
}

// Each cell lies between what clipping finds in a slightly smaller and a slightly larger cell.
void expect_exact(const TriangleMesh& mesh, const Mat3d& R, double cell) {
    const HeightMap map = height_map(raster_mesh(mesh), R, cell);
    const std::vector<Polygon> triangles = turned_triangles(mesh, R);
    double lowest = kInfinity;
    for (const Polygon& triangle : triangles) {
        for (const Vec3d& p : triangle) lowest = std::min(lowest, p.z());
    }
    EXPECT_NEAR(map.bounds.low.z(), lowest, 1e-12);
    const double margin = 1e-4 * cell;
    for (int row = 0; row < map.rows; ++row) {
        for (int column = 0; column < map.stride; ++column) {
            const double x = (map.first_column + column) * cell;
            const double y = (map.first_row + row) * cell;
            const Envelope outer = envelope(triangles, x, y, cell, margin);
            const Envelope inner = envelope(triangles, x, y, cell, -margin);
            const std::size_t at = static_cast<std::size_t>(row) * map.stride + column;
            const double low = double{map.low[at]} + lowest;
            const double high = double{map.high[at]} + lowest;
            ASSERT_GE(low, outer.low - 1e-3) << column << ' ' << row;
            ASSERT_LE(low, inner.low + 1e-3) << column << ' ' << row;
            ASSERT_LE(high, outer.high + 1e-3) << column << ' ' << row;
            ASSERT_GE(high, inner.high - 1e-3) << column << ' ' << row;
        }
    }
}

TriangleMesh box_mesh(const Vec3f& low, const Vec3f& high) {
    TriangleMesh mesh;
    testing::add_box(mesh, low, high);
    return mesh;
}

TEST(HeightMap, OfABoxIsItsHeightInEveryCellItTouches) {
    const HeightMap map =
        height_map(raster_mesh(box_mesh(Vec3f(-2.5F, 1.0F, -3.0F), Vec3f(4.5F, 3.0F, 8.0F))),
                   Mat3d::Identity(), 1.0);
    EXPECT_EQ(map.first_column, -3);
    EXPECT_EQ(map.first_row, 1);
    for (int column = 0; column < 8; ++column) {
        for (int row = 0; row < 2; ++row) {
            EXPECT_EQ(map.low[static_cast<std::size_t>(row * map.stride + column)], 0.0F);
            EXPECT_EQ(map.high[static_cast<std::size_t>(row * map.stride + column)], 11.0F);
        }
    }
    EXPECT_EQ(std::count(map.low.begin(), map.low.begin() + 2 * map.stride, 0.0F), 16);
    EXPECT_EQ(map.bounds.low, Vec3d(-2.5, 1.0, -3.0));
    EXPECT_EQ(map.bounds.high, Vec3d(4.5, 3.0, 8.0));
}

TEST(HeightMap, IsWhatClippingTrianglesToCellsGives) {
    Random random(3);
    for (int i = 0; i < 3; ++i) {
        // Large triangles, then such as are about a cell, then many in each cell.
        expect_exact(testing::corner_model(), random.rotation(), 2.0);
        const TriangleMesh part = make_part(PartKind::l_bracket, {.resolution = 64});
        expect_exact(part, random.rotation(), 2.5);
        expect_exact(part, random.rotation(), 12.0);
    }
}

TEST(HeightMap, IsExactWhereVerticesAndEdgesLieOnTheGrid) {
    expect_exact(testing::corner_model(), Mat3d::Identity(), 5.0);
    // A pyramid whose apex is where four cells meet.
    TriangleMesh pyramid;
    pyramid.vertices = {Vec3f(-3, -3, 0), Vec3f(3, -3, 0), Vec3f(3, 3, 0), Vec3f(-3, 3, 0),
                        Vec3f(0, 0, 9)};
    pyramid.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {0, 2, 1}, {0, 3, 2}};
    const HeightMap map = height_map(raster_mesh(pyramid), Mat3d::Identity(), 1.0);
    for (const int column : {2, 3}) {
        for (const int row : {2, 3}) {
            EXPECT_EQ(map.high[static_cast<std::size_t>(row * map.stride + column)], 9.0F);
        }
    }
}

TEST(HeightMap, RefusesCellsThatAreTooSmall) {
    const RasterMesh mesh = raster_mesh(testing::corner_model());
    EXPECT_THROW(height_map(mesh, Mat3d::Identity(), 1e-3), InvalidInput);
    EXPECT_THROW(height_map(mesh, Mat3d::Identity(), 1e-300), InvalidInput);
    EXPECT_THROW(LandingSurface(0, 0, 100'000, 100'000), InvalidInput);
}

TEST(LandingSurface, StacksBoxesAtTheirHeights) {
    const RasterMesh mesh =
        raster_mesh(box_mesh(Vec3f(0.25F, 0.25F, 5.0F), Vec3f(9.75F, 6.75F, 9.0F)));
    const HeightMap map = height_map(mesh, Mat3d::Identity(), 1.0);
    LandingSurface surface(-40, -40, 40, 40);
    EXPECT_EQ(surface.landing_height(map, 0, 0, kInfinity), 0.0);
    surface.add(map, {0, 0, 0.0});
    EXPECT_EQ(surface.landing_height(map, 0, 0, kInfinity), 4.0);
    EXPECT_EQ(surface.landing_height(map, 9, -6, kInfinity), 4.0);  // one cell in common
    EXPECT_EQ(surface.landing_height(map, 10, 0, kInfinity), 0.0);
    EXPECT_EQ(surface.landing_height(map, 0, 7, kInfinity), 0.0);
    EXPECT_EQ(surface.landing_height(map, 0, 0, 3.0), 3.0);  // not below the limit
    surface.add(map, {5, 3, 4.0});
    EXPECT_EQ(surface.landing_height(map, 10, 5, kInfinity), 8.0);
}

}  // namespace
}  // namespace ostraka
