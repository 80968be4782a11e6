// SPDX-License-Identifier: Apache-2.0
// Makes a mesh from a file fit for ray casting and sampling, or says why it can't be.
#pragma once

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

struct RepairResult {
    TriangleMesh mesh;
    std::size_t welded_vertices = 0;       ///< vertices at exactly the place of an earlier one
    std::size_t degenerate_triangles = 0;  ///< dropped: zero area or a repeated vertex
};

/// Welds equal vertices and drops degenerate triangles and unused vertices.
/// @throws InvalidInput if a vertex is not finite, an index is out of range, there is no triangle,
///         or all triangles have zero area. The message names the first offender.
RepairResult repair(const TriangleMesh& mesh);

}  // namespace ostraka
