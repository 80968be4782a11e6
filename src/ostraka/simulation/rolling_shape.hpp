// SPDX-License-Identifier: Apache-2.0
// What a rigid object needs to roll: its center of mass and what its convex hull touches a plane
// with.
#pragma once

#include <array>
#include <vector>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

/// Offsets are from the center of mass, along the model's axes.
struct RollingShape {
    Vec3d center_of_mass = Vec3d::Zero();  ///< model frame; uniform density
    double radius = 0.0;                   ///< largest distance from the center of mass to a vertex
    std::vector<Vec3d> points;             ///< some vertices of the hull: extreme in 642 directions
    std::array<std::vector<float>, 3> vertices;  ///< x, y and z of all, filled up to whole blocks
};

/// The center of mass is that of the volume if the mesh is closed but for small holes, else that of
/// the surface.
/// @param mesh  repaired: finite, at least one triangle with area.
RollingShape rolling_shape(const TriangleMesh& mesh);

/// The vertex that reaches farthest in a direction, to float precision; of equals, the first.
Vec3d extreme_vertex(const RollingShape& shape, const Vec3d& direction);

}  // namespace ostraka
