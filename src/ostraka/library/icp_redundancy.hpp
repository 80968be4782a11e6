// SPDX-License-Identifier: Apache-2.0
// The study's way to drop redundant candidates (method, 2.5): register them pairwise by ICP and
// drop those that match an earlier one. For comparison with selection.hpp; slower by orders of
// magnitude.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

struct IcpRedundancySettings {
    double max_deviation_ratio = 1.10;  ///< of the extents along each principal direction; pairs
                                        ///< that differ more can't match and are not registered
    double max_distance = 1.0;  ///< between matching points, in distances between those compared
    double min_match = 0.9;     ///< share of either's points that must match
    std::size_t points = 200;   ///< of each cloud that are compared, thinned out evenly
};

/// Indices of the clouds that match no earlier one that is kept, ascending. Pairs are laid onto
/// each other by their principal frames, with every sign that is ambiguous, and then by ICP.
/// @param clouds    with normals, at the sampling distance.
/// @param sampling  the clouds' unit.
std::vector<std::uint32_t> drop_by_icp(std::span<const PointCloud> clouds, double sampling,
                                       const IcpRedundancySettings& settings = {});

}  // namespace ostraka
