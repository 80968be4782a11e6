// SPDX-License-Identifier: Apache-2.0
// Private to this module: from how many directions each side of a point's surface is seen.
#pragma once

#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Cosines between a normal and the directions that the point is seen from, summed.
struct SideVotes {
    float front = 0.0F;  ///< directions that the normal points toward
    float back = 0.0F;   ///< the others, as positive numbers
};

/// Looks at all points from 32 directions far away. A point is hidden where another one of the same
/// cell of the picture lies in front of its tangent plane.
/// @param normals  one for each point, of unit length and any sign.
/// @param spacing  distance of points in the sparser parts, positive.
std::vector<SideVotes> vote_for_sides(std::span<const Vec3f> points, std::span<const Vec3f> normals,
                                      double spacing);

}  // namespace ostraka
