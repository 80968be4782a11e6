// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/point_columns.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

std::map<std::uint32_t, float> brute_force(std::span<const Vec3f> points, const Vec3f& query,
                                           float radius) {
    std::map<std::uint32_t, float> found;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const Vec3f d = query - points[i];
        const float squared = d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
        if (squared < radius * radius) found[i] = squared;
    }
    return found;
}

void expect_exact(std::span<const Vec3f> points, double side, std::span<const Vec3f> queries,
                  float radius) {
    const PointColumns columns(points, side);
    std::vector<Neighbor> neighbors(3);
    for (const Vec3f& query : queries) {
        columns.within(query, radius, neighbors);
        std::map<std::uint32_t, float> found;
        for (const Neighbor& n : neighbors) found[n.index] = n.squared_distance;
        ASSERT_EQ(found.size(), neighbors.size()) << "a point was found twice";
        ASSERT_EQ(found, brute_force(points, query, radius)) << query.transpose();
    }
}

TEST(PointColumns, FindWhatBruteForceFinds) {
    const std::vector<Vec3f> points = test_clouds::in_box(2000, 4, {5.0, 2.0, 9.0}, {70, -8, 400});
    std::vector<Vec3f> queries = test_clouds::in_box(60, 5, {6.0, 3.0, 10.0}, {70, -8, 400});
    queries.insert(queries.end(), points.begin(), points.begin() + 60);
    queries.emplace_back(1e6F, 0.0F, -1e6F);
    for (const double side : {0.11, 0.6, 40.0}) {
        for (const float radius : {0.0F, 0.3F, 1.3F, 500.0F}) {
            expect_exact(points, side, queries, radius);
        }
    }
}

TEST(PointColumns, AgreeWithTheTreeOnDistancesBitByBit) {
    const PointCloud cloud = test_clouds::sphere(1500, 40.0);
    const PointColumns columns(cloud.points, 3.0);
    const KdTree tree(cloud.points);
    std::vector<Neighbor> found;
    std::vector<Neighbor> expected;
    for (std::size_t i = 0; i < cloud.size(); i += 50) {
        columns.within(cloud.points[i], 8.0F, found);
        tree.within(cloud.points[i], 8.0F, expected);
        std::sort(found.begin(), found.end(), [](const Neighbor& a, const Neighbor& b) {
            return std::pair(a.squared_distance, a.index) < std::pair(b.squared_distance, b.index);
        });
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
            ASSERT_EQ(found[k].index, expected[k].index);
            ASSERT_EQ(found[k].squared_distance, expected[k].squared_distance);
        }
    }
}

// On a lattice many points lie exactly on the sphere around a query, and on borders of columns.
TEST(PointColumns, AreExactOnALattice) {
    const std::vector<Vec3f> points = test_clouds::lattice(30, 0.1F);
    for (const float radius : {0.1F, 0.2F, 0.5F}) expect_exact(points, 0.1, points, radius);
}

TEST(PointColumns, AreExactWhereCoordinatesAreCoarse) {
    std::vector<Vec3f> points = test_clouds::in_box(400, 6, {0.5, 0.5, 0.5}, {3e6, -2e6, 1e6});
    expect_exact(points, 0.3, points, 0.4F);
    points = test_clouds::in_box(400, 6, {1e-7, 1e-7, 1e-7});
    expect_exact(points, 3e-8, points, 4e-8F);
}

TEST(PointColumns, TakeDegenerateClouds) {
    const std::vector<Vec3f> same(50, Vec3f(1, 2, 3));
    expect_exact(same, 0.1, same, 0.1F);
    std::vector<Vec3f> line;
    for (int i = 0; i < 300; ++i) line.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    expect_exact(line, 1.0, line, 3.0F);
    // A stray point far away must not cost memory.
    std::vector<Vec3f> stray = test_clouds::in_box(300, 7);
    stray.emplace_back(1e9F, -1e9F, 1e9F);
    expect_exact(stray, 0.05, stray, 0.2F);
    const PointColumns none({}, 1.0);
    std::vector<Neighbor> neighbors(3);
    none.within(Vec3f::Zero(), 1.0F, neighbors);
    EXPECT_TRUE(neighbors.empty());
    EXPECT_THROW(PointColumns(line, 0.0), InvalidInput);
    EXPECT_THROW(PointColumns(line, std::nan("")), InvalidInput);
}

TEST(PointColumns, OrderDependsOnCoordinatesOnly) {
    std::vector<Vec3f> points = test_clouds::lattice(15, 1.0F);
    for (const Vec3f& p : test_clouds::in_box(500, 8, {7, 7, 7})) points.push_back(p);
    std::vector<Vec3f> reversed(points.rbegin(), points.rend());
    const PointColumns a(points, 0.8);
    const PointColumns b(reversed, 0.8);
    ASSERT_EQ(a.column_count(), b.column_count());
    for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_TRUE(
            std::equal(a.coordinate(axis), a.coordinate(axis) + a.size(), b.coordinate(axis)));
    }
    for (std::size_t slot = 0; slot < a.size(); ++slot) {
        const Vec3f at(a.coordinate(0)[slot], a.coordinate(1)[slot], a.coordinate(2)[slot]);
        EXPECT_EQ(at, points[a.order()[slot]]);
    }
}

TEST(PointColumns, BoxesHoldTheirPoints) {
    const std::vector<Vec3f> points = test_clouds::in_box(4000, 9, {3, 1, 2});
    const PointColumns columns(points, 0.3);
    const Vec3f low(-1.0F, -0.5F, 0.2F);
    const Vec3f high(0.6F, 0.1F, 1.1F);
    std::vector<SlotRun> runs;
    columns.runs_in_box(low, high, runs);
    std::vector<bool> covered(points.size(), false);
    std::uint32_t last = 0;
    for (const SlotRun& run : runs) {
        ASSERT_LT(run.begin, run.end);
        ASSERT_GE(run.begin, last);
        last = run.end;
        for (std::uint32_t slot = run.begin; slot < run.end; ++slot) {
            covered[columns.order()[slot]] = true;
        }
    }
    std::size_t inside = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const bool in =
            (points[i].array() >= low.array() && points[i].array() <= high.array()).all();
        if (in) ++inside;
        EXPECT_TRUE(!in || covered[i]);
    }
    EXPECT_GT(inside, 20U);
    EXPECT_LT(std::count(covered.begin(), covered.end(), true), 4 * static_cast<int>(inside));
}

void expect_nearest(std::span<const Vec3f> points, double side, std::span<const Vec3f> queries) {
    const PointColumns columns(points, side);
    const KdTree tree(points);
    std::uint32_t guess = 0;
    for (const Vec3f& query : queries) {
        const float expected = tree.nearest(query).squared_distance;
        float squared = std::numeric_limits<float>::infinity();
        const std::uint32_t slot = columns.nearest_slot(query, kNoIndex, squared);
        ASSERT_NE(slot, kNoIndex);
        ASSERT_EQ(squared, expected) << query.transpose();
        const auto at = [&](std::uint32_t s) { return points[columns.order()[s]]; };
        ASSERT_FLOAT_EQ((at(slot) - query).squaredNorm(), expected);
        // From the last query's answer, however far.
        squared = (at(guess) - query).squaredNorm() * 1.0001F;
        guess = columns.nearest_slot(query, guess, squared);
        ASSERT_FLOAT_EQ((at(guess) - query).squaredNorm(), expected);
        // Within less than its distance there is none.
        squared = expected;
        EXPECT_EQ(columns.nearest_slot(query, kNoIndex, squared), kNoIndex);
        EXPECT_EQ(squared, expected);
    }
}

TEST(PointColumns, FindTheNearest) {
    const std::vector<Vec3f> volume = test_clouds::in_box(1500, 4, {5.0, 2.0, 9.0}, {70, -8, 400});
    std::vector<Vec3f> queries = test_clouds::in_box(300, 5, {9.0, 9.0, 19.0}, {70, -8, 400});
    queries.emplace_back(1e4F, 300.0F, -1e4F);
    for (const double side : {0.2, 1.0, 30.0}) expect_nearest(volume, side, queries);
    const PointCloud surface = test_clouds::sphere(2000, 10.0);
    for (const double side : {0.3, 2.0}) {
        expect_nearest(surface.points, side, test_clouds::in_box(500, 6, {12, 12, 12}));
    }
    const std::vector<Vec3f> same(50, Vec3f(1, 2, 3));
    expect_nearest(same, 0.5, test_clouds::in_box(20, 7));
    expect_nearest(test_clouds::lattice(20, 0.5F), 0.5, test_clouds::in_box(200, 8, {11, 11, 1}));
    float squared = 4.0F;
    EXPECT_EQ(PointColumns({}, 1.0).nearest_slot(Vec3f::Zero(), kNoIndex, squared), kNoIndex);
}

}  // namespace
}  // namespace ostraka
