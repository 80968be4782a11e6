// SPDX-License-Identifier: Apache-2.0
// Points far from each other.
// Eldar, Lindenbaum, Porat, Zeevi. The Farthest Point Strategy for Progressive Image Sampling. IEEE
// Transactions on Image Processing 6(9), 1997.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Each next point is the one farthest from all before it (of equals, the first): the first k
/// points are evenly spread, for any k. Takes count * points.size() steps.
/// @param points  finite, any unit.
/// @param first   index of the first point; less than points.size() unless there are none.
/// @return min(count, points.size()) indices.
std::vector<std::uint32_t> farthest_points(std::span<const Vec3f> points, std::size_t count,
                                           std::uint32_t first = 0);

/// The point farthest from a place; of equals, the first. @param points  at least 1.
std::uint32_t farthest_from(std::span<const Vec3f> points, const Vec3f& place);

}  // namespace ostraka
