// SPDX-License-Identifier: Apache-2.0
// SHOT: Signature of Histograms of OrienTations, 32 volumes x 11 bins of the cosine between
// normals. Tombari, Salti, Di Stefano. Unique Signatures of Histograms for Local Surface
// Description. ECCV 2010. As PCL 1.13, also where it departs from the paper: rows have L2 norm 1
// (not L1), and the cosine's share for the last bin goes to the first one (PCL's `% 10` on 11
// bins).
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/local_descriptor.hpp"

namespace ostraka {

inline constexpr std::size_t kShotLength = 352;

struct ShotSettings {
    float radius = 0.0F;  ///< of the support, in the points' unit; must be set, positive
};

/// SHOT centered on the centroid, with the whole piece as support (radius: 1.0001 times the largest
/// distance to the centroid).
struct GlobalShotSettings {};

/// @param cloud  finite points with unit normals; a NaN normal's point is used for the frame only.
/// @param keypoints  finite, in the cloud's frame; need not be points of the cloud.
/// @return rows of kShotLength floats, non-negative, L2 norm 1. A keypoint with fewer than 5 points
///         (other than itself) in its support has no frame and a row of 0. The same for any order
///         of the points and any number of threads; up to rounding for any rigid motion.
/// @throws InvalidInput if normals are missing, a point or keypoint is not finite, or the radius is
///         not positive.
LocalDescriptors describe_shot(const PointCloud& cloud, std::span<const Vec3f> keypoints,
                               const ShotSettings& settings);

/// The same, for callers that hold a tree over cloud.points. It doesn't speed up the search.
/// @throws InvalidInput also if the tree's size differs.
LocalDescriptors describe_shot(const PointCloud& cloud, const KdTree& tree,
                               std::span<const Vec3f> keypoints, const ShotSettings& settings);

/// @param cloud  at least 1 point, finite, with unit normals; the viewpoint is unused.
/// @return kShotLength floats; 0 where undefined (fewer than 5 points away from the centroid).
/// @throws InvalidInput if there are no points or no normals, or a point is not finite.
std::vector<float> describe_global_shot(const PointCloud& cloud,
                                        const GlobalShotSettings& settings = {});

}  // namespace ostraka
