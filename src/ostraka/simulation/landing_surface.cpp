// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/landing_surface.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr std::int64_t kMaxCells = std::int64_t{1} << 26;
constexpr int kLanes = static_cast<int>(kVectorLanes);
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The greatest below[i] - above[i]; -infinity minus infinity is -infinity, so cells without either
// never count. @param count  whole vectors.
OSTRAKA_VECTOR_CLONES float greatest_overlap(const float* below, const float* above, int count) {
    Float8 greatest = Float8{} - kInfinity;
    for (int i = 0; i < count; i += kLanes) {
        Float8 b;
        Float8 a;
        load8(below + i, b);
        load8(above + i, a);
        const Float8 overlap = b - a;
        greatest = overlap > greatest ? overlap : greatest;
    }
    float result = greatest[0];
    for (int lane = 1; lane < kLanes; ++lane) result = std::max(result, greatest[lane]);
    return result;
}

}  // namespace

LandingSurface::LandingSurface(int first_column, int first_row, int last_column, int last_row)
    : first_column_(first_column), first_row_(first_row) {
    // A map's padding and its spare column may reach beyond the last cell.
    const std::int64_t stride = std::int64_t{last_column} - first_column + 1 + 2 * kLanes;
    const std::int64_t rows = std::int64_t{last_row} - first_row + 2;
    if (stride < 1 || rows < 1 || stride > kMaxCells || rows * stride > kMaxCells) {
        throw InvalidInput("landing surface: more than 2^26 cells");
    }
    rows_ = static_cast<int>(rows);
    stride_ = static_cast<int>(stride);
    heights_.assign(static_cast<std::size_t>(rows * stride), -kInfinity);
    occupied_.assign(static_cast<std::size_t>(rows), {stride_, 0});
}

double LandingSurface::landing_height(const HeightMap& map, int columns, int rows,
                                      double limit) const {
    const int left = map.first_column + columns - first_column_;
    const int top = map.first_row + rows - first_row_;
    assert(left >= 0 && left + map.stride <= stride_ && top >= 0 && top + map.rows <= rows_);
    double height = 0.0;
    for (int row = 0; row < map.rows && height < limit; ++row) {
        const Span& occupied = occupied_[static_cast<std::size_t>(top) + row];
        const int begin = std::max(occupied.begin - left, 0) / kLanes * kLanes;
        const int end = std::min(occupied.end - left, map.stride);
        if (begin >= end) continue;
        const int count = (end - begin + kLanes - 1) / kLanes * kLanes;
        const float* below = heights_.data() + std::size_t(top + row) * stride_ + left + begin;
        const float* above = map.low.data() + std::size_t(row) * map.stride + begin;
        height = std::max(height, double{greatest_overlap(below, above, count)});
    }
    return std::min(height, limit);
}

void LandingSurface::add(const HeightMap& map, const Landing& landing) {
    const int left = map.first_column + landing.columns - first_column_;
    const int top = map.first_row + landing.rows - first_row_;
    assert(left >= 0 && left + map.stride <= stride_ && top >= 0 && top + map.rows <= rows_);
    for (int row = 0; row < map.rows; ++row) {
        float* below = heights_.data() + std::size_t(top + row) * stride_ + left;
        const float* high = map.high.data() + std::size_t(row) * map.stride;
        Span& occupied = occupied_[static_cast<std::size_t>(top) + row];
        for (int i = 0; i < map.columns; ++i) {
            if (high[i] == -kInfinity) continue;
            below[i] = std::max(below[i], static_cast<float>(landing.height + double{high[i]}));
            occupied.begin = std::min(occupied.begin, left + i);
            occupied.end = std::max(occupied.end, left + i + 1);
        }
    }
}

}  // namespace ostraka
