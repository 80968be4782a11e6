// SPDX-License-Identifier: Apache-2.0
// Fewer triangles, nearly the same surface.
// Garland, Heckbert. Surface Simplification Using Quadric Error Metrics. SIGGRAPH 1997.
#pragma once

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

struct SimplifySettings {
    double max_error = 0.02;        ///< in the mesh's unit: how far the surface may move; above 0
    std::size_t min_triangles = 4;  ///< stop there, even if the error would allow fewer
};

/// Collapses edges, cheapest first, while the surface stays within the bound.
/// @param mesh  closed and manifold: every edge has exactly two triangles, in opposite directions,
///              and the triangles around every vertex form one fan.
/// @return closed and manifold, with the same genus and components. Every vertex of `mesh` is
/// within
///         max_error of the result's surface; every vertex of the result is, in the root mean
///         square, within max_error of the planes of the triangles it stands for. No triangle is
///         flipped. The same for the same mesh, bit for bit.
/// @throws InvalidInput if the mesh is not closed and manifold, or max_error is not positive.
TriangleMesh simplify(const TriangleMesh& mesh, const SimplifySettings& settings = {});

}  // namespace ostraka
