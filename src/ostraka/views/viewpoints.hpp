// SPDX-License-Identifier: Apache-2.0
// Viewing directions spread evenly over the sphere: vertices or faces of a subdivided icosahedron.
#pragma once

#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Unit vectors from the object toward the sensor.
/// @param count  12, 42, 162, 642 or 2562 (vertices), or 20, 80, 320 or 1280 (face centers).
/// @throws InvalidInput for any other count.
std::vector<Vec3d> viewpoints(int count);

}  // namespace ostraka
