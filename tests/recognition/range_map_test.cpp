// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/range_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

constexpr double kDistance = 100.0;

// A wall across the view at z = kDistance, with square holes around the given places.
PointCloud wall(double half, double spacing, const std::vector<Vec2d>& holes = {},
                double hole = 0.0) {
    PointCloud cloud;
    for (double y = -half; y <= half; y += spacing) {
        for (double x = -half; x <= half; x += spacing) {
            const bool empty = std::any_of(holes.begin(), holes.end(), [&](const Vec2d& h) {
                return std::abs(x - h.x()) < hole && std::abs(y - h.y()) < hole;
            });
            if (!empty) cloud.points.push_back(Vec3d(x, y, kDistance).cast<float>());
        }
    }
    return cloud;
}

PointCloud ball_around_the_sensor(std::size_t count) {
    PointCloud cloud;
    Random random(2);
    for (std::size_t i = 0; i < count; ++i) {
        cloud.points.push_back(Vec3d(50.0 * random.direction()).cast<float>());
    }
    return cloud;
}

TEST(RangeMap, CellsAndDirectionsAreInverse) {
    for (const PointCloud& cloud : {wall(40.0, 1.0), ball_around_the_sensor(3000)}) {
        const RangeMap map(cloud, {}, cloud, 2.0);
        ASSERT_GT(map.size(), 100U);
        for (std::uint32_t cell = 0; cell < map.size(); ++cell) {
            const Vec3d direction = map.direction(cell);
            ASSERT_NEAR(direction.norm(), 1.0, 1e-6);
            ASSERT_EQ(map.cell_of(Vec3d(70.0 * direction).cast<float>()), cell);
        }
    }
}

TEST(RangeMap, HoldsTheDistanceOfEveryPoint) {
    for (PointCloud cloud : {wall(40.0, 0.5), ball_around_the_sensor(3000)}) {
        const Vec3f shift(10.0F, -30.0F, 5.0F);
        for (Vec3f& point : cloud.points) point += shift;
        cloud.viewpoint = shift;
        const RangeMap map(cloud, {}, cloud, 1.0);
        for (const Vec3f& point : cloud.points) {
            const std::uint32_t cell = map.cell_of(point);
            if (cell == kNoIndex) continue;  // opposite to the middle of a full sphere
            const float range = (point - shift).norm();
            ASSERT_TRUE(map[cell].measured());
            ASSERT_LE(map[cell].near, range);
            ASSERT_GE(map[cell].far, range);
            ASSERT_NE(map[cell].point, kNoIndex);
        }
    }
}

TEST(RangeMap, NearAndFarAreThoseOfOneDirection) {
    PointCloud cloud = wall(20.0, 0.5);
    const Vec3f behind(0.0F, 0.0F, 130.0F);
    cloud.points.push_back(behind);
    const RangeMap map(cloud, {}, wall(20.0, 1.0), 1.0);
    const std::uint32_t cell = map.cell_of(behind);
    ASSERT_NE(cell, kNoIndex);
    EXPECT_NEAR(map[cell].near, 100.0, 0.01);
    EXPECT_FLOAT_EQ(map[cell].far, 130.0F);
}

TEST(RangeMap, KnowsWallsByTheirPointsAndGivesThemNoNeighborsPoint) {
    const PointCloud cloud = wall(20.0, 0.5);
    std::vector<float> extents(cloud.size(), 0.0F);
    PointCloud object;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (cloud.points[i].x() < 0.25F) extents[i] = 500.0F;
    }
    for (const Vec3f& point : wall(20.0, 1.0).points) {
        if (point.x() > 1.0F) object.points.push_back(point);
    }
    const RangeMap map(cloud, extents, object, 1.0);
    const std::uint32_t on_wall = map.cell_of(Vec3f(-10.0F, 3.0F, 100.0F));
    EXPECT_EQ(map[on_wall].wall, 500.0F);
    EXPECT_EQ(map[on_wall].point, kNoIndex);
    const std::uint32_t beside = map.cell_of(Vec3f(10.0F, 3.0F, 100.0F));
    EXPECT_EQ(map[beside].wall, 0.0F);
    EXPECT_NE(map[beside].point, kNoIndex);
}

TEST(RangeMap, ACellKnowsWhatIsNearestAroundIt) {
    PointCloud cloud = wall(20.0, 0.5);
    const Vec3f before(0.0F, 0.0F, 60.0F);
    cloud.points.push_back(before);
    const RangeMap map(cloud, {}, cloud, 1.0);
    const std::uint32_t cell = map.cell_of(before);
    for (const std::uint32_t other : {cell, cell + 1, cell - 1, cell + map.width() + 1}) {
        EXPECT_FLOAT_EQ(map[other].nearest_around, 60.0F);
    }
    EXPECT_NEAR(map[cell + 2].nearest_around, 100.0F, 0.1F);
    EXPECT_FLOAT_EQ(map[cell].near, 60.0F);
}

TEST(RangeMap, NormalsOfACreaseAreNotSteady) {
    PointCloud roof = wall(20.0, 1.0);
    for (Vec3f& point : roof.points) {
        const float side = point.x() < 0.0F ? -1.0F : 1.0F;
        point.z() += 0.8F * std::abs(point.x());
        roof.normals.push_back(Vec3f(0.8F * side, 0.0F, -1.0F).normalized());
    }
    const RangeMap map(roof, {}, roof, 1.0);
    EXPECT_TRUE(map[map.cell_of(Vec3f(10.0F, 0.0F, 108.0F))].steady);
    EXPECT_TRUE(map[map.cell_of(Vec3f(-10.0F, 0.0F, 108.0F))].steady);
    EXPECT_FALSE(map[map.cell_of(Vec3f(0.0F, 0.0F, 100.0F))].steady);
}

TEST(RangeMap, SamplingGapsAreFilledAndHolesAreNot) {
    // Cells are about one sampling distance wide at the wall.
    const PointCloud coarse = wall(30.0, 1.0);
    const PointCloud gap = wall(30.0, 1.0, {Vec2d(10.0, 10.0)}, 0.6);
    const RangeMap with_gap(gap, {}, coarse, 1.0);
    const Vec3f in_gap(10.0F, 10.0F, 100.0F);
    EXPECT_TRUE(with_gap[with_gap.cell_of(in_gap)].measured());
    const PointCloud hole = wall(30.0, 0.5, {Vec2d(10.0, 10.0)}, 6.0);
    const RangeMap with_hole(hole, {}, hole, 1.0);
    EXPECT_FALSE(with_hole[with_hole.cell_of(in_gap)].measured());
}

// A hole in the wall, 40 cells wide, and a post before the wall along the left border of it.
// A sensor whose eyes are kParallax s apart, seen from what is at range s, doesn't see surface at
// range r within kParallax (1 - s / r) radians of it.
TEST(RangeMap, ACellWithoutMeasurementKnowsWhereAShadowBegins) {
    PointCloud cloud = wall(60.0, 0.5, {Vec2d(0.0, 0.0)}, 20.0);
    for (double y = -36.0; y <= 36.0; y += 0.3) {
        for (double x = -16.0; x <= -11.6; x += 0.3) {
            cloud.points.push_back(Vec3d(x, y, 60.0).cast<float>());
        }
    }
    const RangeMap map(cloud, {}, cloud, 1.0);
    const auto at = [&](double x, double y) {
        return map[map.cell_of(Vec3d(x, y, kDistance).cast<float>())];
    };
    ASSERT_FALSE(at(-15.0, 0.0).measured());
    const auto begin = [](double range, double cells) {
        return range / (1.0 - 0.01 * cells / kParallax);
    };
    // The post ends at -11.6 / 60 and the wall at 20 / 100: so many cells of 0.01 beside.
    EXPECT_NEAR(at(-15.0, 0.0).shadow, begin(61.0, 4.5), 4.0);
    EXPECT_NEAR(at(-10.0, 0.0).shadow, begin(61.0, 9.5), 5.0);
    EXPECT_NEAR(at(15.0, 0.0).shadow, begin(102.0, 5.0), 7.0);
    EXPECT_NEAR(at(4.0, 0.0).shadow, begin(102.0, 15.5), 25.0);
    EXPECT_TRUE(std::isinf(at(40.0, 0.0).shadow));  // measured
}

TEST(RangeMap, InvalidPointsAreNoMeasurement) {
    PointCloud cloud = wall(20.0, 0.5);
    const std::size_t valid = cloud.size();
    cloud.points.resize(2 * valid, Vec3f::Constant(std::nanf("")));
    const RangeMap with(cloud, {}, wall(20.0, 1.0), 1.0);
    const RangeMap without(wall(20.0, 0.5), {}, wall(20.0, 1.0), 1.0);
    ASSERT_EQ(with.size(), without.size());
    for (std::uint32_t i = 0; i < with.size(); ++i) EXPECT_EQ(with[i].near, without[i].near);
}

TEST(RangeMap, TheCellsAroundABallAreAllThatSeeIt) {
    Random random(7);
    for (const PointCloud& cloud : {wall(60.0, 1.0), ball_around_the_sensor(4000)}) {
        const RangeMap map(cloud, {}, cloud, 2.0);
        for (int trial = 0; trial < 60; ++trial) {
            const Vec3d center = random.uniform(20.0, 120.0) * random.direction();
            const double radius = random.uniform(2.0, 25.0);
            const auto cells = map.cells_around(center, radius);
            ASSERT_TRUE(std::is_sorted(cells.begin(), cells.end()));
            for (std::uint32_t cell = 0; cell < map.size(); ++cell) {
                const Vec3d direction = map.direction(cell);
                const double along = std::max(0.0, center.dot(direction));
                if ((center - along * direction).norm() > radius) continue;
                ASSERT_TRUE(std::binary_search(cells.begin(), cells.end(), cell)) << trial;
            }
        }
        EXPECT_LT(map.cells_around(Vec3d(0, 0, 100), 3.0).size(), map.size() / 20);
    }
}

TEST(RangeMap, OutsideItsFieldThereIsNoCell) {
    const PointCloud cloud = wall(20.0, 0.5);
    const RangeMap map(cloud, {}, cloud, 1.0);
    EXPECT_EQ(map.cell_of(Vec3f(80.0F, 0.0F, 100.0F)), kNoIndex);
    EXPECT_EQ(map.cell_of(Vec3f(0.0F, 0.0F, -100.0F)), kNoIndex);
    EXPECT_EQ(map.cell_of(Vec3f::Zero()), kNoIndex);
    EXPECT_EQ(map.cell_of(Vec3f::Constant(std::nanf(""))), kNoIndex);
    EXPECT_NE(map.cell_of(Vec3f(0.0F, 0.0F, 500.0F)), kNoIndex);
    EXPECT_EQ(RangeMap({}, {}, {}, 1.0).cell_of(Vec3f(0.0F, 0.0F, 1.0F)), kNoIndex);
}

TEST(RangeMap, StaysSmallForAScanOfManyCells) {
    const PointCloud cloud = wall(90.0, 3.0);
    const RangeMap map(cloud, {}, cloud, 0.001);
    EXPECT_LT(map.size(), 5'000'000U);
    EXPECT_NE(map.cell_of(cloud.points.front()), kNoIndex);
}

TEST(RangeMap, RejectsASensorOnTheScan) {
    PointCloud cloud;
    cloud.points.assign(20, Vec3f(1, 2, 3));
    cloud.viewpoint = Vec3f(1, 2, 3);
    EXPECT_THROW(RangeMap(cloud, {}, cloud, 1.0), InvalidInput);
}

}  // namespace
}  // namespace ostraka
