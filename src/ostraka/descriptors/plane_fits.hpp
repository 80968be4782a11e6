// SPDX-License-Identifier: Apache-2.0
// Private to this module: planes through fixed-radius neighborhoods, without neighbor lists.
// As PCL 1.13's NormalEstimation: the point itself belongs to its neighborhood.
#pragma once

#include <span>
#include <vector>

#include "ostraka/base/types.hpp"
#include "ostraka/descriptors/cell_order.hpp"

namespace ostraka {

/// Points sorted into cells, as columns in that order and padded for whole vectors.
struct OrderedPoints {
    /// @param points  finite. @param cell  side of a cell, their unit, positive.
    OrderedPoints(std::span<const Vec3f> points, float cell);

    CellOrder cells;
    std::vector<float> x, y, z;  ///< by position in cells.order()
};

struct PlaneFits {
    std::vector<Vec3f> normals;  ///< unit, either side; NaN with fewer than 3 points around, or all
                                 ///< on a line
    std::vector<float> variations;  ///< least variance over the sum of all three; 0 where undefined
};

/// The plane through all points closer than `radius` to each point, by index. Fastest if the cells
/// are as large as the radius.
PlaneFits fit_planes(const OrderedPoints& points, float radius);

}  // namespace ostraka
