// SPDX-License-Identifier: Apache-2.0
// Finds the crossings without visiting the empty part of the grid: a block of cells whose center is
// farther from the surface than its corners holds no surface, as fields are Lipschitz. On the way
// down the tree the solid loses what can't matter in the block, so leaves are cheap to sample.
#include "ostraka/simulation/contour_grid.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

constexpr int kBlock = 4;               // cells along the side of a leaf
constexpr int kCorners = kBlock + 1;    // corners along the side of a leaf
constexpr double kMargin = 2.0;         // cells around a leaf in which its solid must be right
constexpr double kRootAccuracy = 1e-9;  // of a cell
constexpr double kGradientStep = 1e-5;  // of a cell

struct Block {
    std::array<int, 3> low;
    Solid solid;
};

ContourGrid make_grid(const Bounds3& bounds, int resolution) {
    const Vec3d size = bounds.high - bounds.low;
    if (!size.allFinite() || size.minCoeff() <= 0.0) {
        throw InvalidInput("contour: the bounds of the solid are infinite or empty");
    }
    if (resolution < 8 || resolution > 512) {
        throw InvalidInput("contour: the resolution must be from 8 to 512");
    }
    ContourGrid grid;
    grid.cell = size.maxCoeff() / resolution;
    // Odd offsets, so that faces at round coordinates don't run through rows of corners.
    grid.origin = bounds.low - grid.cell * Vec3d(1.4131, 1.3719, 1.4373);
    for (int axis = 0; axis < 3; ++axis) {
        grid.cells[axis] = static_cast<int>(std::ceil(size[axis] / grid.cell)) + 3;
    }
    return grid;
}

// Appends the leaves under a block that may hold surface.
void descend(const ContourGrid& grid, const Solid& solid, const std::array<int, 3>& low, int size,
             std::vector<Block>& leaves) {
    for (int axis = 0; axis < 3; ++axis) {
        if (low[axis] >= grid.cells[axis]) return;
    }
    const Vec3d center = grid.corner(low) + Vec3d::Constant(0.5 * size * grid.cell);
    const double half_diagonal = 0.5 * std::sqrt(3.0) * size * grid.cell;
    if (std::abs(solid.distance(center)) > half_diagonal * (1.0 + 1e-9)) return;
    const Solid local = solid.specialized(center, half_diagonal + kMargin * grid.cell);
    if (size <= kBlock) {
        leaves.push_back({low, local});
        return;
    }
    const int half = size / 2;
    for (int child = 0; child < 8; ++child) {
        descend(grid, local,
                {low[0] + (child & 1) * half, low[1] + (child >> 1 & 1) * half,
                 low[2] + (child >> 2) * half},
                half, leaves);
    }
}

// The root between two points on a line, by false position with bisection as the safeguard.
double find_root(const Solid& solid, const Vec3d& start, const Vec3d& step, double at_start,
                 double at_end) {
    double low = 0.0;
    double high = 1.0;
    double at_low = at_start;
    double at_high = at_end;
    for (int i = 0; i < 60 && high - low > kRootAccuracy; ++i) {
        double middle = 0.5 * (low + high);
        if (i % 3 != 2) {  // every third step halves the bracket, whatever the field does
            middle = std::clamp(low + (high - low) * at_low / (at_low - at_high), low, high);
        }
        const double value = solid.distance(start + middle * step);
        if (std::abs(value) <= kRootAccuracy * step.norm()) return middle;
        if ((value < 0.0) == (at_start < 0.0)) {
            low = middle;
            at_low = value;
        } else {
            high = middle;
            at_high = value;
        }
    }
    return 0.5 * (low + high);
}

std::vector<Crossing> crossings_of(const ContourGrid& grid, const Block& block,
                                   std::uint32_t index) {
    std::array<double, kCorners * kCorners * kCorners> values;
    const auto slot = [](int i, int j, int k) { return (k * kCorners + j) * kCorners + i; };
    for (int k = 0; k < kCorners; ++k) {
        for (int j = 0; j < kCorners; ++j) {
            for (int i = 0; i < kCorners; ++i) {
                values[slot(i, j, k)] = block.solid.distance(
                    grid.corner({block.low[0] + i, block.low[1] + j, block.low[2] + k}));
            }
        }
    }
    std::vector<Crossing> found;
    // A leaf owns the edges that start in it and not on its upper sides.
    for (int item = 0; item < kBlock * kBlock * kBlock * 3; ++item) {
        const int axis = item % 3;
        std::array<int, 3> at = {item / 3 % kBlock, item / (3 * kBlock) % kBlock,
                                 item / (3 * kBlock * kBlock)};
        const double low_value = values[slot(at[0], at[1], at[2])];
        std::array<int, 3> end = at;
        ++end[axis];
        const double high_value = values[slot(end[0], end[1], end[2])];
        if ((low_value < 0.0) == (high_value < 0.0)) continue;
        for (int a = 0; a < 3; ++a) at[a] += block.low[a];
        const Vec3d start = grid.corner(at);
        Vec3d step = Vec3d::Zero();
        step[axis] = grid.cell;
        const double t = find_root(block.solid, start, step, low_value, high_value);
        const Vec3d point = start + t * step;
        found.push_back({at, axis, low_value < 0.0, index, point,
                         block.solid.gradient(point, kGradientStep * grid.cell)});
    }
    return found;
}

}  // namespace

CrossingSet find_crossings(const Solid& solid, int resolution) {
    CrossingSet set;
    set.grid = make_grid(solid.bounds(), resolution);
    int size = kBlock;
    while (size < *std::max_element(set.grid.cells.begin(), set.grid.cells.end())) size *= 2;
    std::vector<Block> leaves;
    descend(set.grid, solid, {0, 0, 0}, size, leaves);

    std::vector<std::vector<Crossing>> found(leaves.size());
    parallel_for(
        leaves.size(),
        [&](std::size_t i) {
            found[i] = crossings_of(set.grid, leaves[i], static_cast<std::uint32_t>(i));
        },
        16);
    for (const auto& part : found) {
        set.crossings.insert(set.crossings.end(), part.begin(), part.end());
    }
    for (Block& leaf : leaves) set.blocks.push_back(std::move(leaf.solid));
    return set;
}

}  // namespace ostraka
