// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/cell_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

using Key = std::array<long, 3>;

// Points by cell, in ascending order of (x, y, z).
std::map<Key, std::vector<std::uint32_t>> brute_force(const std::vector<Vec3f>& points,
                                                      double cell) {
    Vec3f low = points.front();
    for (const Vec3f& point : points) low = low.cwiseMin(point);
    std::map<Key, std::vector<std::uint32_t>> cells;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        Key key{};
        for (int axis = 0; axis < 3; ++axis) {
            key.at(static_cast<std::size_t>(axis)) =
                static_cast<long>(std::floor((double{points[i][axis]} - double{low[axis]}) / cell));
        }
        cells[key].push_back(i);
    }
    return cells;
}

TEST(CellGrid, SortsPointsIntoCellsInOrder) {
    const std::vector<Vec3f> points = test_clouds::in_box(500, 1, {1.0, 2.0, 0.5});
    const CellGrid grid(points, 0.3);
    const auto expected = brute_force(points, 0.3);
    ASSERT_EQ(grid.cell_count(), expected.size());
    std::size_t c = 0;
    for (const auto& [key, members] : expected) {
        const auto found = grid.members(c);
        ASSERT_TRUE(std::equal(found.begin(), found.end(), members.begin(), members.end()));
        for (const std::uint32_t i : members) ASSERT_EQ(grid.cell_of(i), c);
        ++c;
    }
}

TEST(CellGrid, NeighborhoodIsTheNonEmptyCellsAround) {
    const std::vector<Vec3f> points = test_clouds::in_box(300, 2);
    const double cell = 0.35;
    const CellGrid grid(points, cell);
    std::vector<Key> keys;
    for (const auto& [key, members] : brute_force(points, cell)) keys.push_back(key);
    std::vector<std::uint32_t> found;
    for (std::uint32_t c = 0; c < keys.size(); ++c) {
        std::vector<std::uint32_t> expected;
        for (std::uint32_t other = 0; other < keys.size(); ++other) {
            long apart = 0;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                apart = std::max(apart, std::abs(keys[c][axis] - keys[other][axis]));
            }
            if (apart <= 1) expected.push_back(other);
        }
        grid.neighborhood(c, found);
        std::sort(found.begin(), found.end());
        ASSERT_EQ(found, expected);
    }
}

TEST(CellGrid, HoldsTheLargestExtentAndRejectsMore) {
    const std::vector<Vec3f> points = {{0, 0, 0}, {1048575.0F, 1048575.0F, 1048575.0F}};
    const CellGrid grid(points, 1.0);
    ASSERT_EQ(grid.cell_count(), 2U);
    std::vector<std::uint32_t> around;
    grid.neighborhood(1, around);
    EXPECT_EQ(around, std::vector<std::uint32_t>{1});
    EXPECT_THROW(CellGrid(points, 0.99), InvalidInput);
}

TEST(CellGrid, RejectsCellsThatAreNotPositive) {
    const std::vector<Vec3f> points = {{0, 0, 0}, {1, 1, 1}};
    for (const double cell : {0.0, -1.0, std::nan("")}) {
        EXPECT_THROW(CellGrid(points, cell), InvalidInput);
    }
}

TEST(CellGrid, NoPointsGiveNoCells) {
    EXPECT_EQ(CellGrid({}, 1.0).cell_count(), 0U);
}

}  // namespace
}  // namespace ostraka
