// SPDX-License-Identifier: Apache-2.0
// Private to simulation: where a solid's surface crosses the edges of a grid of cubic cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ostraka/simulation/solid.hpp"

namespace ostraka {

/// Corner (i, j, k) is at origin + cell * (i, j, k).
struct ContourGrid {
    Vec3d origin = Vec3d::Zero();
    double cell = 1.0;                     ///< side of a cell
    std::array<int, 3> cells = {0, 0, 0};  ///< along each axis

    Vec3d corner(const std::array<int, 3>& at) const {
        return origin + cell * Vec3d(at[0], at[1], at[2]);
    }
};

/// The surface passes through a grid edge.
struct Crossing {
    std::array<int, 3> corner;  ///< the edge's low end
    int axis;                   ///< the edge goes to the next corner along this axis
    bool low_inside;            ///< the low end is inside the solid
    std::uint32_t block;        ///< into CrossingSet::blocks
    Vec3d point;
    Vec3d normal;  ///< unit, outward
};

struct CrossingSet {
    ContourGrid grid;
    std::vector<Crossing> crossings;  ///< no edge twice; same order on every run
    std::vector<Solid> blocks;        ///< the solid, specialized to a neighborhood of the crossing
};

/// @throws InvalidInput as contour() does.
CrossingSet find_crossings(const Solid& solid, int resolution);

}  // namespace ostraka
