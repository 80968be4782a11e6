// SPDX-License-Identifier: Apache-2.0
// Connected groups of points: by distance alone, or by distance and smoothness.
// Rabbani, van den Heuvel, Vosselman. Segmentation of Point Clouds Using Smoothness Constraint.
// ISPRS 2006. Departs from the paper: two neighbors join when their normals agree (a union of
// pairs, independent of seeds and order), instead of growing from the flattest seed.
#pragma once

#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

/// Groups of point indices, each ascending; largest group first, ties by smallest index.
using Clusters = std::vector<std::vector<std::uint32_t>>;

/// Points closer than `tolerance` belong together (single linkage).
/// @param points     finite.
/// @param tolerance  in the points' unit, positive.
/// @param min_size   smaller groups are left out.
Clusters euclidean_clusters(std::span<const Vec3f> points, double tolerance,
                            std::size_t min_size = 1);

/// Which points are closer than a tolerance, as adjacency lists: for repeated clustering of
/// subsets.
struct ProximityGraph {
    std::vector<std::uint32_t> starts;  ///< size() + 1 offsets into neighbors
    std::vector<std::uint32_t>
        neighbors;  ///< of point i: neighbors[starts[i]] to neighbors[starts[i + 1]]
};
ProximityGraph proximity_graph(std::span<const Vec3f> points, double tolerance);

/// The largest connected group among the points at `indices` (ascending); the group with the
/// smallest index of equally large ones. Ascending.
std::vector<std::uint32_t> largest_group(const ProximityGraph& graph,
                                         std::span<const std::uint32_t> indices);

/// The same for nested subsets at once, each step costing only what is new.
/// @param level   per point: the first subset that holds it; `levels` or more: none does.
/// @return for each level l, the largest group among the points of level 0 to l.
std::vector<std::vector<std::uint32_t>> largest_groups(const ProximityGraph& graph,
                                                       std::span<const std::uint8_t> level,
                                                       std::size_t levels);

struct SmoothnessSettings {
    double tolerance = 0.0;       ///< distance that joins two points, in the cloud's unit
    double max_angle = 0.2;       ///< radians between the normals of joined points
    double max_curvature = 0.04;  ///< mean squared sine between a point's normal and those around
                                  ///< it, above which it lies on a crease; 0 to 1
    std::size_t min_size = 1;     ///< smaller groups are left out
};

/// Points closer than the tolerance whose normals agree belong together; points on creases (high
/// variation of the normals around them) separate groups and are then given to the nearest one.
/// @param cloud  finite points with normals.
Clusters smooth_clusters(const PointCloud& cloud, const SmoothnessSettings& settings);

}  // namespace ostraka
