// SPDX-License-Identifier: Apache-2.0
// OUR-CVFH: Oriented, Unique and Repeatable CVFH; rows of 308 floats with reference frames.
// Aldoma, Tombari, Rusu, Vincze. OUR-CVFH - Oriented, Unique and Repeatable Clustered Viewpoint
// Feature Histogram for Object Recognition and 6DOF Pose Estimation. DAGM 2012.
// As PCL 1.13: CVFH's rows without distances, over whose bins 135 to 238 (the empty block and the
// viewpoint's first 59 of 128) lie the 8 x 13 distances by octant of the region's frame.
// From PCL: cloud.viewpoint is used; PCL ignores its setViewPoint() and takes the origin. The width
// over which octants share a point is a share of the extent, where PCL has 1 cm in meters
// (`octant_width`). PCL's frames are mirrored: their y axis is the opposite of ours, which doesn't
// change the rows. See cvfh_regions.hpp for what departs in the regions.
#pragma once

#include <span>

#include "ostraka/descriptors/cvfh.hpp"

namespace ostraka {

inline constexpr std::size_t kOurCvfhLength = kVfhLength;

struct OurCvfhSettings {
    CvfhRegionSettings regions;  ///< what is a smooth region
    float refinement = 1.0F;     ///< points whose normal is farther than this times
                                 ///< regions.max_angle from the region's leave it; 0: none leaves
    float axis_ratio = 0.8F;     ///< above this ratio of the two axes' ambiguities both get a frame
    float min_axis_value = 0.925F;  ///< above this ambiguity of both, each axis gets both signs
    float octant_width = 0.0F;    ///< standard deviation, cloud's unit, over which octants share a
                                  ///< point; 0: a tenth of the largest distance; PCL: 0.01
    bool normalize_bins = false;  ///< blocks sum to 100 instead of the number of points
};

/// @param cloud  at least 1 point, finite, with normals; cloud.viewpoint is used.
/// @param curvatures  one for each point or empty, see smooth_regions().
/// @return rows of kOurCvfhLength non-negative floats, 1, 2 or 4 for each region, one for each of
///         its frames; a single VFH row around the centroid if there is no region. T_frame_cloud
///         is a right-handed motion: origin at the region's centroid, z the region's direction of
///         least spread on the side of its normal, x the direction of the region that tells its two
///         sides best apart. Where two pieces have like rows, T_a_b = T_frame_a^-1 * T_frame_b.
/// @throws InvalidInput if there are no points or no normals, a point is not finite, or as
///         smooth_regions().
RegionalDescriptors describe_our_cvfh(const PointCloud& cloud, std::span<const float> curvatures,
                                      const OurCvfhSettings& settings = {});

/// The same with curvatures computed from the points.
RegionalDescriptors describe_our_cvfh(const PointCloud& cloud,
                                      const OurCvfhSettings& settings = {});

}  // namespace ostraka
