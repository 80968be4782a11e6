// SPDX-License-Identifier: Apache-2.0
// Private to this module: the local reference frame of SHOT.
#pragma once

#include "ostraka/descriptors/support.hpp"

namespace ostraka {

/// Principal directions of the support, nearer points weighing more, signs by majority.
/// @return R_local_cloud, right-handed; NaN if fewer than 5 points are away from the keypoint.
Mat3f shot_frame(const Support& support, float radius);

}  // namespace ostraka
