// SPDX-License-Identifier: Apache-2.0
// Pose errors. Hinterstoisser et al. Model Based Training, Detection and Pose Estimation. ACCV
// 2012.
#pragma once

#include <span>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// ADI: mean distance from each model point at its true pose to the closest model point at the
/// estimated pose. Forgives symmetry. In the points' unit; 0 for no points.
double adi_error(std::span<const Vec3f> model_points, const Pose& T_scene_model_true,
                 const Pose& T_scene_model_estimated);

}  // namespace ostraka
