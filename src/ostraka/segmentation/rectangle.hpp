// SPDX-License-Identifier: Apache-2.0
// Private to this module: the rectangle of least area around points in a plane.
// Freeman, Shapira. Determining the Minimum-Area Encasing Rectangle for an Arbitrary Closed Curve.
// CACM 18(7), 1975: one side lies on an edge of the convex hull.
#pragma once

#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

struct Rectangle {
    Vec2d center = Vec2d::Zero();
    Vec2d along = Vec2d::UnitX();   ///< unit, the direction of the longer side
    Vec2d extents = Vec2d::Zero();  ///< longer side, shorter side
};

/// @param points  at least one, finite. Cost n log n, and the square of the hull's corners.
Rectangle smallest_rectangle(std::vector<Vec2d> points);

}  // namespace ostraka
