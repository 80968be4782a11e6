// SPDX-License-Identifier: Apache-2.0
// PCL's triangulation, which its RoPS needs.
#pragma once

#include <pcl/Vertices.h>

#include <vector>

#include "pcl_clouds.hpp"

namespace ostraka::bench {

/// Greedy projection with the settings of PCL's own examples. @param edge  longest edge.
std::vector<pcl::Vertices> pcl_triangles(const PclPoints& points, const PclNormals& normals,
                                         double edge);

}  // namespace ostraka::bench
