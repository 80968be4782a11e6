// SPDX-License-Identifier: Apache-2.0
// RoPS: Rotational Projection Statistics, 3 axes x 3 rotations x 3 planes x 5 statistics.
// Guo, Sohel, Bennamoun, Lu, Wan. Rotational Projection Statistics for 3D Local Surface Description
// and Object Recognition. IJCV 105(1), 2013.
// As PCL 1.13, also where it departs from the paper: the rotations are 22.5, 45 and 67.5 degrees,
// the frame's weights are not divided by the total area, and rows are divided by their L1 norm.
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/local_descriptor.hpp"
#include "ostraka/descriptors/triangulation.hpp"

namespace ostraka {

inline constexpr std::size_t kRopsLength = 135;

struct RopsSettings {
    float radius = 0.0F;  ///< of the support, in the points' unit; must be set, positive
};

/// RoPS centered on the centroid, with the whole piece as support (radius: 1.0001 times the largest
/// distance to the centroid).
struct GlobalRopsSettings {
    TriangulationSettings triangulation;
};

/// @param cloud  finite points; normals unused.
/// @param triangles  of the surface, indices into cloud.points, as from triangulate() or a mesh.
/// @param keypoints  finite, in the cloud's frame; need not be points of the cloud.
/// @return rows of kRopsLength floats, L1 norm 1. A keypoint whose support holds no triangle of
///         positive area has no frame and a row of 0. Any number of threads gives the same bits; a
///         rigid motion may move single points into another bin.
/// @throws InvalidInput if a point or keypoint is not finite, an index is out of range or the
/// radius
///         is not positive.
LocalDescriptors describe_rops(const PointCloud& cloud, std::span<const IndexTriangle> triangles,
                               std::span<const Vec3f> keypoints, const RopsSettings& settings);

/// The same, for callers that hold a tree over cloud.points. It doesn't speed up the search.
/// @throws InvalidInput also if the tree's size differs.
LocalDescriptors describe_rops(const PointCloud& cloud, const KdTree& tree,
                               std::span<const IndexTriangle> triangles,
                               std::span<const Vec3f> keypoints, const RopsSettings& settings);

/// @param cloud  at least 1 point, finite, with unit normals; the viewpoint is unused.
/// @return kRopsLength floats; 0 where undefined (no triangle of positive area).
/// @throws InvalidInput if there are no points or no normals, or a point is not finite.
std::vector<float> describe_global_rops(const PointCloud& cloud,
                                        const GlobalRopsSettings& settings = {});

/// The same on triangles that exist already; normals unused.
std::vector<float> describe_global_rops(const PointCloud& cloud,
                                        std::span<const IndexTriangle> triangles);

}  // namespace ostraka
