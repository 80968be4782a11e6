// SPDX-License-Identifier: Apache-2.0
// Private to this module: OUR-CVFH's frames (SGURF) and the distances by octant in them.
#pragma once

#include <span>
#include <vector>

#include "ostraka/descriptors/our_cvfh.hpp"

namespace ostraka {

inline constexpr std::size_t kOctants = 8;
inline constexpr std::size_t kOctantBins = 13;

/// The semi-global unique reference frames of a region: rotations R_frame_cloud whose rows are x, y
/// and z; 1, or 2 or 4 where the sides of the piece can't be told apart.
std::vector<Mat3d> region_frames(const PointCloud& cloud, const SmoothRegion& region,
                                 const OurCvfhSettings& settings);

/// Where points lie seen from a frame: for each octant a histogram of their distances.
/// @param normalize  the sum is 100 * n / (n - 1) instead of the number of points n.
/// @param bins  kOctants x kOctantBins floats, replaced.
void octant_distances(const PointCloud& cloud, const Pose& T_frame_cloud, float octant_width,
                      bool normalize, std::span<float> bins);

}  // namespace ostraka
