// SPDX-License-Identifier: Apache-2.0
// How high and how low a turned mesh reaches over each cell of a square grid in the horizontal
// plane. The bounds are those of the surface over the whole cell, not at a sample: two meshes whose
// columns do not overlap anywhere cannot interpenetrate, whatever their shape.
// Exact, not by clipping: the height of a triangle over a cell is extreme at a vertex in the cell,
// where an edge crosses the cell's border, or at a corner of the cell under the triangle. So each
// vertex, each edge and each triangle is visited once, and vertical triangles are nothing special.
#pragma once

#include <vector>

#include "ostraka/simulation/raster_mesh.hpp"
#include "ostraka/simulation/solid.hpp"

namespace ostraka {

/// Cell (i, j), counted from the map's first, covers [first_column + i, first_column + i + 1] cells
/// along x and the same with rows along y of the frame to which the mesh was turned.
struct HeightMap {
    int first_column = 0;  ///< may be negative
    int first_row = 0;     ///< may be negative
    int columns = 0;
    int rows = 0;
    int stride = 0;          ///< floats from row to row: columns filled up to whole vectors
    std::vector<float> low;  ///< rows x stride: lowest height above bounds.low.z(); +infinity: none
    std::vector<float> high;  ///< rows x stride: highest height above the same; -infinity: none
    Bounds3 bounds;           ///< of the turned vertices, to double precision
};

/// Heights are right to about 1e-7 of the mesh's size, for a mesh whose vertices are moved by as
/// little.
/// @param cell  side of a cell in the mesh's unit; above 0.
/// @throws InvalidInput if the map would have more than 2^26 cells.
HeightMap height_map(const RasterMesh& mesh, const Mat3d& R_world_model, double cell);

}  // namespace ostraka
