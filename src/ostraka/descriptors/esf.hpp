// SPDX-License-Identifier: Apache-2.0
// ESF: Ensemble of Shape Functions, ten histograms of 64 bins over random point triples.
// Wohlkinger, Vincze. Ensemble of Shape Functions for 3D Object Classification. ROBIO 2011.
// Follows PCL 1.13 where it departs from the paper: three vertices give three angles, each weighted
// by the traced length of the opposite side; distances on the surface fill the block named "in".
// Departs from PCL: the triples come from a hash of a seed, not from the clock, drawn without
// rejecting repeated indices (same distribution); the work is bounded where no triangle exists.
#pragma once

#include <cstdint>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

inline constexpr std::size_t kEsfLength = 640;

struct EsfSettings {
    int samples = 20'000;    ///< point triples drawn; noise of a bin falls as 1/sqrt(samples)
    std::uint64_t seed = 0;  ///< same seed and point order, same row
};

/// @param cloud  at least 1 point, finite, any frame and unit; normals and viewpoint unused.
/// @return kEsfLength floats, non-negative, sum 1; all 0 where fewer than 3 points or no triangle
///         of noticeable area exists. Invariant to translation and scale up to rounding; to
///         rotation and point order only up to sampling noise (the voxel grid is axis-aligned and
///         the triples are drawn by index).
/// @throws InvalidInput if there are no points, a point is not finite, or `samples` is below 1.
std::vector<float> describe_esf(const PointCloud& cloud, const EsfSettings& settings = {});

}  // namespace ostraka
