// SPDX-License-Identifier: Apache-2.0
// All planes of a scan: each connected flat piece of surface, largest first.
// Region growing over patches, after: Poppinga, Vaskevicius, Birk, Pathak. Fast Plane Detection and
// Polygonalization in Noisy 3D Range Images. IROS 2008. Departs from the paper: what grows are
// patches with mean normals instead of pixels; edges are settled point by point at the end, all
// planes at once; and a piece that bends is no plane, however well it fits. (Repeated RANSAC would
// need trials in proportion to the inverse cube of the smallest plane's share, and finds slices
// through curved surfaces.)
#pragma once

#include <vector>

#include "ostraka/segmentation/patches.hpp"

namespace ostraka {

struct PlanePieceSettings {
    double tolerance = 0.7;   ///< sampling distances from the plane that count as on it
    double max_angle = 0.2;   ///< radians between a patch's normal and the plane's
    double edge_angle = 0.5;  ///< radians between a point's normal and the plane's; larger, because
                              ///< normals at an edge are blended with those beyond it
    double max_bend = 0.2;    ///< radians by which the surface may turn from one side of a piece to
                              ///< the other; more is a curved surface
    double min_width = 3.0;   ///< sampling distances; a narrower piece is an edge, not a plane
    std::size_t min_points = 60;  ///< smaller pieces are left out
};

struct PlanePiece {
    std::vector<std::uint32_t> indices;  ///< points, ascending
    Vec3d normal = Vec3d::UnitZ();       ///< unit, toward the viewpoint
    double offset = 0.0;                 ///< normal . x = offset for points x on the plane
    double roughness = 0.0;              ///< root mean square distance of the points, cloud's unit
    /// The smallest rectangle around the points: origin in its center, x along its longer side, z
    /// the normal; right-handed. A half turn about z is as good.
    Pose T_cloud_piece = Pose::Identity();
    Vec2d extents = Vec2d::Zero();  ///< the rectangle's sides along x and y, cloud's unit
};

/// Every connected flat piece, largest first (ties: smallest index). Two pieces share no point.
/// Deterministic; the same pieces whatever the order of the points.
/// @param cloud    at an even density, with normals toward the viewpoint; NaN points are left out.
/// @param patches  how to cut the cloud; patches.sampling is the cloud's and must be set.
/// @throws InvalidInput if normals are missing or patches.sampling isn't positive.
std::vector<PlanePiece> find_planes(const PointCloud& cloud, const PatchSettings& patches,
                                    const PlanePieceSettings& settings = {});

/// The same on a cloud that is cut already. @param patches  of this cloud (see surface_patches()).
/// @param sampling  the distance between neighboring points.
std::vector<PlanePiece> find_planes(const PointCloud& cloud, const SurfacePatches& patches,
                                    double sampling, const PlanePieceSettings& settings = {});

}  // namespace ostraka
