// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/range_shadows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace ostraka {
namespace {

constexpr double kAngle = 0.005;
constexpr CellRows kRows{200, 120, kAngle};
constexpr double kPlate = 60.0;
constexpr double kWall = 100.0;
constexpr std::uint32_t kLeft = 70;  // first column of the plate, and
constexpr std::uint32_t kRight = 110;
constexpr std::uint32_t kTop = 40;
constexpr std::uint32_t kBottom = 80;

// A wall, a plate before it, and beside the plate `shadow` columns without measurement.
std::vector<RangeCell> plate_before_wall(std::uint32_t shadow, std::uint32_t bottom = kBottom) {
    std::vector<RangeCell> cells(std::size_t{kRows.width} * kRows.height);
    for (std::uint32_t v = 0; v < kRows.height; ++v) {
        for (std::uint32_t u = 0; u < kRows.width; ++u) {
            RangeCell& cell = cells[std::size_t{v} * kRows.width + u];
            const bool beside = v >= kTop && v < bottom;
            if (beside && u >= kRight && u < kRight + shadow) continue;
            const bool plate = beside && u >= kLeft && u < kRight;
            cell.near = cell.far = static_cast<float>(plate ? kPlate : kWall);
        }
    }
    return cells;
}

// Baseline that makes a shadow of so many cells on the wall.
double baseline_of(double cells) {
    return cells * kAngle / (1.0 / kPlate - 1.0 / kWall);
}

TEST(RangeShadows, BaselineIsMeasuredOnTheSideOfTheShadow) {
    const Baselines found = measure_baselines(plate_before_wall(12), kRows);
    EXPECT_NEAR(found[0], baseline_of(12.0), baseline_of(3.0));
    for (const std::size_t side : {1, 2, 3}) EXPECT_LT(found[side], baseline_of(3.0)) << side;
}

TEST(RangeShadows, SensorWithoutParallaxCastsNone) {
    std::vector<RangeCell> cells = plate_before_wall(0);
    // A hole in the wall, ten cells beside the plate: no edge of a shadow.
    const std::size_t hole = std::size_t{60} * kRows.width + kRight + 10;
    cells[hole] = {};
    const Baselines found = measure_baselines(cells, kRows);
    for (std::size_t side = 0; side < 4; ++side) {
        EXPECT_LT(found[side], baseline_of(3.0)) << side;
    }
    mark_shadows(cells, kRows, found);
    EXPECT_TRUE(cells[hole].shadow > static_cast<float>(kWall));
}

TEST(RangeShadows, FewEdgesTellNothing) {
    const Baselines found = measure_baselines(plate_before_wall(12, kTop + 10), kRows);
    EXPECT_TRUE(std::isinf(found[0]));
    EXPECT_TRUE(std::isinf(found[1]));
}

// The camera sees lit wall between a narrow post and its shadow: no gap there doesn't mean no
// shadow.
TEST(RangeShadows, NarrowThingsTellNothing) {
    std::vector<RangeCell> cells(std::size_t{kRows.width} * kRows.height);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const std::size_t column = i % kRows.width;
        const bool post = column >= kLeft && column < kLeft + 8;
        cells[i].near = cells[i].far = static_cast<float>(post ? kPlate : kWall);
    }
    for (const double baseline : measure_baselines(cells, kRows)) {
        EXPECT_TRUE(std::isinf(baseline));
    }
}

// The wall's cells in the shadow may be hidden from the light, the plate's own depth may not; a
// cell farther beside than the baseline reaches may not either.
TEST(RangeShadows, MeasuredShadowEndsWhereTheBaselineEnds) {
    std::vector<RangeCell> cells = plate_before_wall(12);
    mark_shadows(cells, kRows, measure_baselines(cells, kRows));
    const std::size_t row = std::size_t{60} * kRows.width;
    for (std::uint32_t i = 0; i < 12; ++i) {
        const float shadow = cells[row + kRight + i].shadow;
        EXPECT_LT(shadow, static_cast<float>(kWall)) << i;
        EXPECT_GT(shadow, static_cast<float>(kPlate)) << i;
    }
    // With a shorter baseline the same empty cells are no shadow of the plate's.
    const Baselines shorter = {baseline_of(4.0), baseline_of(4.0), 1.0, 1.0};
    std::vector<RangeCell> others = plate_before_wall(12);
    mark_shadows(others, kRows, shorter);
    EXPECT_GT(others[row + kRight + 8].shadow, static_cast<float>(kWall));
}

}  // namespace
}  // namespace ostraka
