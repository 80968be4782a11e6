// SPDX-License-Identifier: Apache-2.0
// PFH: Point Feature Histograms, 5 x 5 x 5 bins of three angles.
// Rusu, Blodow, Marton, Beetz. Aligning Point Cloud Views using Persistent Feature Histograms.
// IROS 2008. As PCL 1.13, also where it departs from the paper: the fourth feature, the distance,
// is left out. From PCL: points with a NaN normal are left out (PCL's result is then undefined).
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/local_descriptor.hpp"

namespace ostraka {

inline constexpr std::size_t kPfhLength = 125;

struct PfhSettings {
    float radius = 0.0F;  ///< of the support, in the points' unit; must be set, positive
};

/// The histogram of the angles of all pairs among the points closer than the radius. The work grows
/// with the square of their number.
/// @param cloud  finite points with unit normals; a NaN normal's point is left out.
/// @param keypoints  finite, in the cloud's frame; need not be points of the cloud.
/// @return rows of kPfhLength floats, non-negative, sum 100; bin a + 5 b + 25 c counts the angle
///         around the normal, the cosine to the axis across and the cosine to the line. A row of 0
///         with fewer than 2 points within the radius. No frames. The same bits for any order of
///         the points and any number of threads; up to rounding for any rigid motion and scale.
/// @throws InvalidInput if normals are missing, a point is not finite, or the radius is not
///         positive.
LocalDescriptors describe_pfh(const PointCloud& cloud, std::span<const Vec3f> keypoints,
                              const PfhSettings& settings);

/// The same with the arguments of the other local descriptors. The search is PFH's own, so the
/// tree is only checked: it must be over cloud.points.
LocalDescriptors describe_pfh(const PointCloud& cloud, const KdTree& tree,
                              std::span<const Vec3f> keypoints, const PfhSettings& settings);

}  // namespace ostraka
