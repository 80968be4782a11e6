// SPDX-License-Identifier: Apache-2.0
// Private to this module: the triangles of an organized cloud.
#pragma once

#include "ostraka/descriptors/triangulation.hpp"

namespace ostraka {

/// @param cloud  organized; NaN points are holes.
std::vector<IndexTriangle> triangulate_grid(const PointCloud& cloud,
                                            const TriangulationSettings& settings);

}  // namespace ostraka
