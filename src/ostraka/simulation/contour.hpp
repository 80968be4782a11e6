// SPDX-License-Identifier: Apache-2.0
// From a solid to a closed triangle mesh with sharp edges.
// Ju, Losasso, Schaefer, Warren. Dual Contouring of Hermite Data. SIGGRAPH 2002.
#pragma once

#include "ostraka/mesh/triangle_mesh.hpp"
#include "ostraka/simulation/solid.hpp"

namespace ostraka {

struct ContourSettings {
    int resolution = 96;        ///< cubic cells along the longest side of the bounds, 8 to 512
    double sharp_angle = 0.35;  ///< radians; normals of a cell that differ less are a smooth face
};

/// The surface of a solid. Details thinner than about 1.5 cells may be lost or torn.
/// @param solid  with finite bounds that contain it.
/// @return closed: every edge has exactly two triangles, in opposite directions; outward oriented;
///         in the solid's frame and unit. Without vertices if no cell corner is inside.
/// @throws InvalidInput if the bounds are infinite or empty, or a setting is out of range.
TriangleMesh contour(const Solid& solid, const ContourSettings& settings = {});

}  // namespace ostraka
