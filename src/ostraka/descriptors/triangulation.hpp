// SPDX-License-Identifier: Apache-2.0
// A fast local triangulation of a cloud: the surface that RoPS integrates over, not a mesh to show.
// Unorganized clouds: each point's Delaunay star among its neighbors, in its tangent plane, after
// Gopi, Krishnan, Silva. Surface Reconstruction Based on Lower Dimensional Localized Delaunay
// Triangulation. Eurographics 2000. A triangle is kept if two of its three stars hold it.
// Organized clouds: two triangles for each grid cell whose corners belong together.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

/// Three indices into the cloud's points.
using IndexTriangle = std::array<std::uint32_t, 3>;

struct TriangulationSettings {
    float longest_edge = 4.0F;  ///< longest edge, in mean distances to the nearest neighbor
                                ///< (organized: in median edge lengths)
};

/// @param cloud  unorganized: finite points with unit normals (a point with a NaN normal gets no
///               triangle of its own); organized: NaN points are holes, normals unused.
/// @return triangles, each once, counter-clockwise as seen from the side the normals (organized:
/// the
///         viewpoint) are on. May have small holes, and rarely overlaps; not a manifold. The same
///         for any number of threads.
/// @throws InvalidInput if an unorganized cloud has no normals or a point is not finite.
std::vector<IndexTriangle> triangulate(const PointCloud& cloud,
                                       const TriangulationSettings& settings = {});

}  // namespace ostraka
