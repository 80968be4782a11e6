// SPDX-License-Identifier: Apache-2.0
// A scan as a grid of vertices in a picture, about as dense as the scan.
#pragma once

#include <vector>

#include "ostraka/recognition/picture_camera.hpp"

namespace ostraka {

struct GridVertex {
    float u = 0.0F;      ///< column in the picture, pixels
    float v = 0.0F;      ///< row in the picture, pixels
    float depth = 0.0F;  ///< along the camera's z axis, the scan's unit; 0: no vertex
    float shade = 0.0F;  ///< brightness, 0 to 1
    bool valid() const { return depth > 0.0F; }
};

struct ScanGrid {
    int columns = 0;
    int rows = 0;
    float spacing = 1.0F;  ///< typical distance between neighbors, pixels
    std::vector<GridVertex> vertices;

    const GridVertex& at(int column, int row) const {
        return vertices[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                        static_cast<std::size_t>(column)];
    }
};

/// An organized scan's own grid; any other scan's points averaged in square cells. Holes of a few
/// vertices are filled. Not shaded.
ScanGrid make_grid(const PointCloud& scene, const PictureCamera& camera);

/// Whether no jump in depth separates two vertices: the surface between them is at most 80 degrees
/// oblique.
bool joined(const GridVertex& a, const GridVertex& b, double focal);

/// Sets every vertex's shade by a plane fitted to its neighbors.
void shade_grid(ScanGrid& grid, const PinholeCamera& camera);

}  // namespace ostraka
