// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

/// RMS distance of a point from the tangent plane of the point next to it, where the surface isn't
/// creased; cloud's unit. Of a model it is its detail at that density, of a scan its noise as well.
/// @param surface  with normals.
double surface_roughness(const PointCloud& surface);

}  // namespace ostraka
