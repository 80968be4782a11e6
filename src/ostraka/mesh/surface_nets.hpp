// SPDX-License-Identifier: Apache-2.0
// Private to this module: a mesh of where the distance field of oriented points is zero.
// Gibson. Constrained Elastic Surface Nets. 1998 (one vertex a cell; here each is moved onto the
// zero set along the field's gradient instead of relaxed).
#pragma once

#include "ostraka/mesh/distance_blocks.hpp"
#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

/// @param open_edge  CloudSurfaceSettings::open_edge.
/// @return in cells; counter-clockwise from where the distance is positive; maybe unused vertices.
TriangleMesh surface_nets(std::span<const Splat> splats, double open_edge);

}  // namespace ostraka
