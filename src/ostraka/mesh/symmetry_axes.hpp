// SPDX-License-Identifier: Apache-2.0
// Private to mesh: directions that the axis of a symmetry may have.
#pragma once

#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// The critical directions of the moments of points and normals, most critical first: the principal
/// directions, then all others. Every axis of a symmetry is near one of them, save for those across
/// an axis of an order above 6 or a continuous one, which moments can't tell apart.
/// @param points, normals  samples of the surface, of even density, about their mean.
/// @return unit vectors, up to sign no two within 3 degrees; at most 50.
std::vector<Vec3d> candidate_axes(std::span<const Vec3f> points, std::span<const Vec3f> normals);

}  // namespace ostraka
