// SPDX-License-Identifier: Apache-2.0
// Hypotheses from flat faces and their borders, for boxy and flat parts, whose surface gives local
// descriptors little to tell apart. What is seen of a face lies within the face: that leaves few
// places for it. After: Faugeras, Hebert. The Representation, Recognition, and Locating of 3-D
// Objects. IJRR 5(3), 1986 (planes paired one by one, the rigid motion constrained by each).
// Departs from the paper: one face or two that meet are enough, as their borders fix what their
// planes leave free.
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

/// A flat face of a model, or what a scan shows of one.
struct FlatFace {
    Vec3d center = Vec3d::Zero();    ///< of the smallest rectangle around it
    Mat3d axes = Mat3d::Identity();  ///< columns: along that rectangle's longer side, its shorter
                                     ///< one, and outward from the surface; right-handed
    std::vector<Vec3d> outline;      ///< corners of about its convex hull
    double extent = 0.0;             ///< longer side of the rectangle
    std::vector<std::uint32_t> indices;  ///< points of the cloud on it

    Vec3d normal() const { return axes.col(2); }
};

/// The flat faces of a surface, largest first.
/// @param cloud     at an even density, with normals; these say which side is outside.
/// @param sampling  distance between neighboring points.
std::vector<FlatFace> flat_faces(const PointCloud& cloud, double sampling);

/// Poses T_scene_model in which what is seen of one face, or of two at an angle, lies on and within
/// faces of the model, its border on theirs in some way. Best filled faces first.
/// @param slack  how far beyond a face's border a point may be, scan's unit.
/// @param most   poses; the others are left out.
std::vector<Pose> poses_from_faces(std::span<const FlatFace> scene, std::span<const FlatFace> model,
                                   double slack, std::size_t most);

}  // namespace ostraka
