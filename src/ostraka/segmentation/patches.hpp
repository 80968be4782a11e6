// SPDX-License-Identifier: Apache-2.0
// A scan cut into small, nearly flat patches that don't cross creases, and which of them touch:
// what planes and convex parts are put together from. Papon, Abramov, Schoeler, Woergoetter. Voxel
// Cloud Connectivity Segmentation: Supervoxels for Point Clouds. CVPR 2013. Departs from the paper:
// points of an even density take the place of voxels, there are no colors, and all patches grow at
// once through one queue, cheapest point first, so that the result doesn't depend on the order of
// patches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/cloud/clusters.hpp"
#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

struct PatchSettings {
    double sampling = 0.0;  ///< distance between neighboring points, in the cloud's unit; positive
    double reach = 2.0;     ///< sampling distances: points closer than that are connected
    double spacing = 4.0;   ///< sampling distances between the centers of patches
    double normal_weight = 4.0;  ///< of 1 - cos(angle to the patch's normal) against the squared
                                 ///< distance to its center in spacings
    int sweeps = 1;  ///< times that patches grow; each but the first from new centers. More round
                     ///< their shapes, and change planes and parts little
};

struct SurfacePatch {
    Vec3d center = Vec3d::Zero();        ///< mean of the points
    Vec3d normal = Vec3d::UnitZ();       ///< unit; mean of the points' normals
    double roughness = 0.0;              ///< root mean square distance from the plane of these two
    std::vector<std::uint32_t> indices;  ///< points, ascending
};

/// Two patches that touch.
struct PatchContact {
    std::uint32_t a = 0;  ///< patch, less than b
    std::uint32_t b = 0;
    std::uint32_t pairs = 0;       ///< connected pairs of points, one of each patch
    Vec3d middle = Vec3d::Zero();  ///< mean of these points
};

struct SurfacePatches {
    ProximityGraph graph;                 ///< points closer than the reach
    std::vector<std::uint32_t> patch_of;  ///< per point
    std::vector<SurfacePatch> patches;
    std::vector<PatchContact> contacts;  ///< every touching pair once
};

/// The points of a cloud in an order that depends on where they are, not on how they came
/// (equal points: on their indices). Points that aren't finite, or whose normal isn't, are left
/// out.
/// @param among     indices of points to consider, each once.
/// @param sampling  in the cloud's unit, positive.
/// @throws InvalidInput if normals are missing, an index is out of range, or sampling isn't
/// positive.
std::vector<std::uint32_t> spatial_order(const PointCloud& cloud,
                                         std::span<const std::uint32_t> among, double sampling);
/// The same for all points.
std::vector<std::uint32_t> spatial_order(const PointCloud& cloud, double sampling);

/// Cuts a cloud into patches. Every point belongs to exactly one; each patch is connected.
/// @param cloud  finite points with finite normals; in their spatial_order() for a result that
///               doesn't depend on the order they came in.
/// @throws InvalidInput if normals are missing or a setting is not positive.
SurfacePatches surface_patches(const PointCloud& cloud, const PatchSettings& settings);

}  // namespace ostraka
