// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/farthest_points.hpp"

#include <gtest/gtest.h>

#include <set>

namespace ostraka {
namespace {

std::vector<Vec3f> row_of(int count) {
    std::vector<Vec3f> points;
    for (int i = 0; i < count; ++i) points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    return points;
}

TEST(FarthestPoints, HalveALine) {
    EXPECT_EQ(farthest_points(row_of(9), 5), (std::vector<std::uint32_t>{0, 8, 4, 2, 6}));
    EXPECT_EQ(farthest_points(row_of(9), 3, 4), (std::vector<std::uint32_t>{4, 0, 8}));
}

TEST(FarthestPoints, AreAllOfFewPointsEachOnce) {
    const auto all = farthest_points(row_of(7), 100);
    EXPECT_EQ(all.size(), 7U);
    EXPECT_EQ(std::set<std::uint32_t>(all.begin(), all.end()).size(), 7U);
    EXPECT_TRUE(farthest_points({}, 5).empty());
    EXPECT_TRUE(farthest_points(row_of(7), 0).empty());
}

TEST(FarthestFrom, IsTheFirstOfTheFarthest) {
    EXPECT_EQ(farthest_from(row_of(9), Vec3f(3, 0, 0)), 8U);
    EXPECT_EQ(farthest_from(row_of(9), Vec3f(4, 1, 0)), 0U);
}

}  // namespace
}  // namespace ostraka
