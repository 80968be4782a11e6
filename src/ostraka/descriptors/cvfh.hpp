// SPDX-License-Identifier: Apache-2.0
// CVFH: Clustered Viewpoint Feature Histogram, one row of 308 floats for each smooth region.
// Aldoma, Vincze, Blodow, Gossow, Gedikli, Rusu, Bradski. CAD-Model Recognition and 6DOF Pose
// Estimation Using 3D Cues. ICCV Workshops 2011.
// As PCL 1.13: a VFH of the whole piece around each region's centroid and normal; the fourth block
// holds distances; bins are counts, so that rows carry the size and survive occlusion (the paper).
// From PCL: cloud.viewpoint is used; PCL ignores its setViewPoint() and takes the origin. See
// cvfh_regions.hpp for what departs in the regions.
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/cvfh_regions.hpp"
#include "ostraka/descriptors/vfh.hpp"

namespace ostraka {

inline constexpr std::size_t kCvfhLength = kVfhLength;

struct CvfhSettings {
    CvfhRegionSettings regions;   ///< what is a smooth region
    bool normalize_bins = false;  ///< blocks sum to 100 instead of the number of points
};

/// Rows of a semi-global descriptor and what each one belongs to.
struct RegionalDescriptors {
    std::vector<float> rows;                   ///< row-major, finite; at least 1 row
    std::vector<SmoothRegion> regions;         ///< largest first; may be empty
    std::vector<std::uint32_t> region_of_row;  ///< into regions; kNoIndex: the whole piece
    std::vector<Pose> T_frame_cloud;  ///< a frame for each row, centered on its region; identity
                                      ///< without a region; empty if the descriptor has none
};

/// @param cloud  at least 1 point, finite, with normals; cloud.viewpoint is used.
/// @param curvatures  one for each point or empty, see smooth_regions().
/// @return rows of kCvfhLength non-negative floats, one for each region; a single row around the
///         centroid and mean normal if there is no region. T_frame_cloud is empty.
/// @throws InvalidInput if there are no points or no normals, a point is not finite, or as
///         smooth_regions().
RegionalDescriptors describe_cvfh(const PointCloud& cloud, std::span<const float> curvatures,
                                  const CvfhSettings& settings = {});

/// The same with curvatures computed from the points.
RegionalDescriptors describe_cvfh(const PointCloud& cloud, const CvfhSettings& settings = {});

}  // namespace ostraka
