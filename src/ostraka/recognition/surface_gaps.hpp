// SPDX-License-Identifier: Apache-2.0
// Gaps of a flat surface: boxes side by side are no wall.
#pragma once

#include <vector>

#include "ostraka/segmentation/plane_pieces.hpp"

namespace ostraka {

/// The parts of a flat piece of a scan that gaps separate: lines along which rays go through its
/// plane, or nothing is measured. What is in front leaves open what is behind: it separates
/// nothing. A gap is found from about three pixels on.
/// @param scan   finite points from one viewpoint, which is set.
/// @param pitch  distance between neighboring points across the line of sight, positive.
/// @param slack  distance from the plane that counts as on it.
/// @return the piece itself if nothing separates it. Otherwise its parts, first the one that lies
///         lowest along its axes; each with its rectangle along these axes, and without indices.
std::vector<PlanePiece> part_at_gaps(const PlanePiece& piece, const PointCloud& scan, double pitch,
                                     double slack);

}  // namespace ostraka
