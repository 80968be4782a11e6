// SPDX-License-Identifier: Apache-2.0
// Private to this module: the statistics of RoPS in a frame that is known.
#pragma once

#include <span>
#include <vector>

#include "ostraka/descriptors/support.hpp"

namespace ostraka {

/// Memory that keypoints share.
struct RopsScratch {
    std::vector<float> x, y, z;       // the points in the local frame
    std::vector<float> u, v;          // two coordinates, rotated
    std::vector<std::uint16_t> cell;  // of each point, in a grid of 5 x 5 x 5
};

/// @param row  135 floats, replaced; L1 norm 1, or all 0 for an empty support.
void rops_statistics(const Support& support, const Mat3f& R_local_cloud, RopsScratch& scratch,
                     std::span<float> row);

}  // namespace ostraka
