// SPDX-License-Identifier: Apache-2.0
// Evenly spread samples of a surface.
// Eldar, Lindenbaum, Porat, Zeevi. The Farthest Point Strategy for Progressive Image Sampling.
// 1997.
#pragma once

#include <cstdint>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

struct SurfaceSamples {
    std::vector<Vec3f> points;   ///< on the surface, in the mesh's frame and unit
    std::vector<Vec3f> normals;  ///< unit normals of the triangles, by their winding
};

/// `count` points drawn uniformly by area. @param mesh  repaired: at least one triangle with area.
SurfaceSamples sample_uniformly(const TriangleMesh& mesh, std::size_t count,
                                std::uint64_t seed = 0);

/// `count` points far from each other: the farthest-point subset of 8 * count uniform samples. The
/// first k of them are themselves evenly spread, for any k.
SurfaceSamples sample_evenly(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed = 0);

}  // namespace ostraka
