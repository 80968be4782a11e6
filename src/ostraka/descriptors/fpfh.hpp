// SPDX-License-Identifier: Apache-2.0
// FPFH: Fast Point Feature Histograms, 3 angles x 11 bins.
// Rusu, Blodow, Beetz. Fast Point Feature Histograms (FPFH) for 3D Registration. ICRA 2009.
// As PCL 1.13, also where it departs from the paper: neighbors weigh 1 / squared distance (not 1 /
// distance), a point's own histogram is left out, and each angle's 11 bins sum to 100.
// `paper_weights` gives the paper's way. From PCL: points with a NaN normal are left out (PCL's
// result is then undefined), and rows don't depend on the order of the points.
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/local_descriptor.hpp"

namespace ostraka {

inline constexpr std::size_t kFpfhLength = 33;

struct FpfhSettings {
    float radius = 0.0F;         ///< of the support, in the points' unit; must be set, positive
    bool paper_weights = false;  ///< as the paper: the keypoint's own histogram, plus the mean of
                                 ///< its neighbors', each times radius / distance
};

/// The histogram of a keypoint: those of the points closer than the radius, each of which counts
/// the angles between its normal, its own neighbors' normals and the line to them.
/// @param cloud  finite points with unit normals; a NaN normal's point is left out.
/// @param keypoints  finite, in the cloud's frame; need not be points of the cloud.
/// @return rows of kFpfhLength floats, non-negative; three blocks of 11 (the angle around the
///         normal, the cosine to the axis across, the cosine to the line), each with sum 100. A row
///         of 0 where no other point is within the radius. No frames. The same bits for any order
///         of the points and any number of threads; up to rounding for any rigid motion and scale.
/// @throws InvalidInput if normals are missing, a point is not finite, or the radius is not
///         positive.
LocalDescriptors describe_fpfh(const PointCloud& cloud, std::span<const Vec3f> keypoints,
                               const FpfhSettings& settings);

/// The same with the arguments of the other local descriptors. The search is FPFH's own, so the
/// tree is only checked: it must be over cloud.points.
LocalDescriptors describe_fpfh(const PointCloud& cloud, const KdTree& tree,
                               std::span<const Vec3f> keypoints, const FpfhSettings& settings);

/// A row for each point of the cloud: the same as describe_fpfh() with keypoints cloud.points.
LocalDescriptors describe_fpfh(const PointCloud& cloud, const FpfhSettings& settings);

}  // namespace ostraka
