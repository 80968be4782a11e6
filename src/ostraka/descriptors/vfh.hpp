// SPDX-License-Identifier: Apache-2.0
// VFH: Viewpoint Feature Histogram, 308 bins.
// Rusu, Bradski, Thibaux, Hsu. Fast 3D Recognition and Pose Using the Viewpoint Feature Histogram.
// IROS 2010.
// As PCL 1.13, also where it departs from the paper: three blocks of 45 bins over [-pi, pi] for an
// angle and two cosines, 45 empty bins (PCL's distance block, off by default) and 128 bins for the
// viewpoint; the mean normal is not brought to unit length. One departure is not followed by
// default: PCL divides the direction to the viewpoint by sqrt(distance^2 + 1), so that the last
// block depends on the unit of length. In millimeters the two agree to 1e-5; in meters PCL's VFH of
// the same object changes with its distance, which cost half of the recognition rate in our trial.
#pragma once

#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

inline constexpr std::size_t kVfhLength = 308;

struct VfhSettings {
    bool pcl_viewpoint_length = false;  ///< divide the viewpoint's direction as PCL 1.13 does
};

/// @param cloud  at least 1 point, finite, with unit normals; cloud.viewpoint is used. A point with
/// a
///               NaN normal, or at the centroid, adds nothing to the blocks that need more.
/// @return kVfhLength non-negative floats; each of blocks 1 to 3 and 5 sums to nearly 100. The same
///         for any order of the points; a rigid motion may move single points into another bin.
/// @throws InvalidInput if there are no points or no normals, or a point is not finite.
std::vector<float> describe_vfh(const PointCloud& cloud, const VfhSettings& settings = {});

}  // namespace ostraka
