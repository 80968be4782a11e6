// SPDX-License-Identifier: Apache-2.0
// A mesh made ready to be painted on height maps again and again.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

using MeshEdge = std::array<std::uint32_t, 2>;

/// Neighbors in space are neighbors in memory. Unused vertices are left out.
struct RasterMesh {
    std::array<std::vector<float>, 3> vertices;  ///< x, y and z in the model's frame, filled up to
                                                 ///< whole vectors of 8 with the first vertex
    std::vector<MeshEdge> edges;                 ///< every edge once, lower index first
    std::vector<Triangle> triangles;             ///< the mesh's own, in another order
};

/// @param mesh  repaired: finite, indices in range, at least one triangle.
RasterMesh raster_mesh(const TriangleMesh& mesh);

}  // namespace ostraka
