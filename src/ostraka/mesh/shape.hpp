// SPDX-License-Identifier: Apache-2.0
// Size and canonical frame of a mesh, the same however the mesh is turned.
#pragma once

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

struct MeshShape {
    Vec3d center = Vec3d::Zero();  ///< center of the smallest enclosing ball (to 1 % of the radius)
    double radius = 0.0;           ///< largest distance from `center` to a vertex
    double diameter = 0.0;         ///< largest distance between two vertices (to 0.5 %)
    Mat3d axes = Mat3d::Identity();  ///< columns: principal directions of the surface,
                                     ///< right-handed, longest first, signs by the third moment
};

/// Measures a mesh. @param mesh  repaired: finite, at least one triangle with area.
MeshShape measure(const TriangleMesh& mesh);

}  // namespace ostraka
