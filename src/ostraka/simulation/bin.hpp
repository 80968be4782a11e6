// SPDX-License-Identifier: Apache-2.0
// An open box into which objects are dropped.
#pragma once

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

/// Centered on the world's z axis, sides along x and y; all in the models' unit.
struct BinSettings {
    double length = 0.0;  ///< inside, along x; above 0
    double width = 0.0;   ///< inside, along y; above 0
    double height = 0.0;  ///< from floor to rim; above 0
    double wall = 0.0;    ///< thickness of walls and floor; above 0
};

/// A bin that holds a dozen objects. @param diameter  mean of the objects'.
BinSettings usual_bin(double diameter);

/// @throws InvalidInput if a measure is not above 0 and finite.
void check(const BinSettings& bin);

/// Floor and walls to render with a scene: closed, outward oriented. The floor's upper side is at
/// z = 0, where a table would be.
TriangleMesh bin_mesh(const BinSettings& bin);

}  // namespace ostraka
