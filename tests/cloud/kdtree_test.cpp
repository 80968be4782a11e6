// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/kdtree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

// All points by (distance, index). The distance is summed as the tree does: x, y, z, in floats.
std::vector<Neighbor> brute_force(const std::vector<Vec3f>& points, const Vec3f& query) {
    std::vector<Neighbor> all;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        float sum = 0.0F;
        for (int axis = 0; axis < 3; ++axis) {
            const float difference = query[axis] - points[i][axis];
            sum += difference * difference;
        }
        all.push_back({i, sum});
    }
    std::sort(all.begin(), all.end(), [](const Neighbor& a, const Neighbor& b) {
        return std::pair(a.squared_distance, a.index) < std::pair(b.squared_distance, b.index);
    });
    return all;
}

void expect_same(const std::vector<Neighbor>& found, const std::vector<Neighbor>& expected,
                 std::size_t count) {
    ASSERT_EQ(found.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(found[i].squared_distance, expected[i].squared_distance) << "neighbor " << i;
        ASSERT_EQ(found[i].index, expected[i].index) << "neighbor " << i;
    }
}

void compare_with_brute_force(const std::vector<Vec3f>& points, const std::vector<Vec3f>& queries,
                              const std::vector<float>& radii) {
    const KdTree tree(points);
    std::vector<Neighbor> found;
    for (const Vec3f& query : queries) {
        const std::vector<Neighbor> expected = brute_force(points, query);
        EXPECT_EQ(tree.nearest(query).index, expected.front().index);
        for (const std::size_t k : {1UL, 2UL, 8UL, 27UL, points.size(), points.size() + 5}) {
            tree.nearest(query, k, found);
            expect_same(found, expected, std::min(k, points.size()));
        }
        for (const float radius : radii) {
            tree.within(query, radius, found);
            const auto inside = static_cast<std::size_t>(
                std::count_if(expected.begin(), expected.end(), [&](const Neighbor& neighbor) {
                    return neighbor.squared_distance < radius * radius;
                }));
            expect_same(found, expected, inside);
        }
    }
}

TEST(KdTree, AgreesWithBruteForceOnRandomPoints) {
    const std::vector<Vec3f> points = test_clouds::in_box(600, 1);
    std::vector<Vec3f> queries = test_clouds::in_box(40, 2, Vec3d::Constant(1.5));
    queries.insert(queries.end(), points.begin(), points.begin() + 40);
    compare_with_brute_force(points, queries, {0.05F, 0.3F, 1.0F, 10.0F});
}

// On a lattice nearly everything is a tie: the lower index must win, wherever the tree cuts.
TEST(KdTree, BreaksTiesByIndex) {
    std::vector<Vec3f> points;
    for (int i = 0; i < 512; ++i) {
        points.emplace_back(static_cast<float>(i % 8), static_cast<float>(i / 8 % 8),
                            static_cast<float>(i / 64));
    }
    std::vector<Vec3f> queries = {{3.5F, 3.5F, 3.5F}, {3.0F, 4.0F, 2.0F}, {-1.0F, -1.0F, 9.0F}};
    for (const std::uint32_t i : {0U, 100U, 333U}) queries.push_back(points[i]);
    compare_with_brute_force(points, queries, {1.0F, 1.5F, 3.0F});
}

TEST(KdTree, FindsAllDuplicates) {
    std::vector<Vec3f> points(70, Vec3f(1.0F, 2.0F, 3.0F));
    const std::vector<Vec3f> others = test_clouds::in_box(70, 3);
    points.insert(points.end(), others.begin(), others.end());
    points.insert(points.end(), others.begin(), others.end());
    compare_with_brute_force(points, {points[0], others[0], others[33], Vec3f::Zero()},
                             {1e-6F, 0.5F, 8.0F});
}

// Far from the origin float coordinates have few digits left, and distances many ties.
TEST(KdTree, AgreesWithBruteForceFarFromTheOrigin) {
    const Vec3d far(5e4, -3e4, 8e4);
    const std::vector<Vec3f> points = test_clouds::in_box(400, 4, Vec3d::Ones(), far);
    compare_with_brute_force(points, test_clouds::in_box(40, 5, Vec3d::Constant(1.2), far),
                             {0.1F, 0.5F});
}

TEST(KdTree, FlatAndThinCloudsAreNoSpecialCase) {
    compare_with_brute_force(test_clouds::in_box(300, 6, {1.0, 1.0, 0.0}),
                             test_clouds::in_box(20, 7), {0.3F});
    compare_with_brute_force(test_clouds::in_box(300, 8, {1.0, 0.0, 0.0}),
                             test_clouds::in_box(20, 9), {0.3F});
}

TEST(KdTree, EmptyTreeAndZeroNeighborsGiveNothing) {
    const std::vector<Vec3f> none;
    const KdTree empty(none);
    std::vector<Neighbor> found(3);
    EXPECT_EQ(empty.size(), 0U);
    EXPECT_EQ(empty.nearest(Vec3f::Zero()).index, kNoIndex);
    empty.nearest(Vec3f::Zero(), 4, found);
    EXPECT_TRUE(found.empty());
    found.resize(3);
    empty.within(Vec3f::Zero(), 1.0F, found);
    EXPECT_TRUE(found.empty());

    const std::vector<Vec3f> one = {Vec3f::Zero()};
    const KdTree tree(one);
    found.resize(3);
    tree.nearest(Vec3f::Zero(), 0, found);
    EXPECT_TRUE(found.empty());
    tree.within(Vec3f::Zero(), 0.0F, found);
    EXPECT_TRUE(found.empty()) << "the radius is exclusive";
}

TEST(KdTree, CanBeMoved) {
    const std::vector<Vec3f> points = test_clouds::in_box(100, 10);
    KdTree first(points);
    const KdTree second(std::move(first));
    EXPECT_EQ(second.nearest(points[42]).index, 42U);
}

TEST(KdTree, AnswersManyThreadsAtOnce) {
    const std::vector<Vec3f> points = test_clouds::in_box(3000, 11);
    const KdTree tree(points);
    std::vector<std::uint32_t> nearest(points.size());
    parallel_for(points.size(), [&](std::size_t i) { nearest[i] = tree.nearest(points[i]).index; });
    for (std::uint32_t i = 0; i < points.size(); ++i) ASSERT_EQ(nearest[i], i);
}

}  // namespace
}  // namespace ostraka
