// SPDX-License-Identifier: Apache-2.0
// Private: paints the lowest and highest heights of a mesh on a grid.
// What lies on the border of cells is noted there, once, and handed to the cells at the end. So
// each vertex, each crossing of an edge with a line of the grid, and each corner under a triangle
// is one note. Almost all edges and triangles of a fine mesh meet no more than one line on each
// axis: these go through loops without branches, in blocks; the others one by one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/simulation/height_map.hpp"

namespace ostraka {

/// Vertices in cells from the map's first cell (x, y, at least 0) and in height (z).
struct GridVertices {
    std::vector<float> x;
    std::vector<float> y;
    std::vector<float> z;
};

/// Fills map.low and map.high. @param map  place and size are set; the last row and column are
/// spare: no vertex is in them but by rounding.
void paint(const RasterMesh& mesh, const GridVertices& vertices, HeightMap& map);

}  // namespace ostraka
