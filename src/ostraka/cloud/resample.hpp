// SPDX-License-Identifier: Apache-2.0
// One sampling distance for library and scan: descriptors of different densities don't compare.
#pragma once

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

/// The mean of the points in each cubic cell of side `spacing`; normals are averaged and normalized
/// (a cell whose normals cancel is dropped), colors averaged. Invalid points are left out.
/// @param spacing  in the cloud's unit, positive.
/// @return unorganized, in the order of the cells; the same viewpoint.
/// @throws InvalidInput if the cloud spans more than 2^20 cells.
PointCloud resample(const PointCloud& cloud, double spacing);

/// Mesh resolution (mr): mean distance from a point to its nearest neighbor.
/// @param points  finite. @return 0 for fewer than 2 points.
double mesh_resolution(std::span<const Vec3f> points);

}  // namespace ostraka
