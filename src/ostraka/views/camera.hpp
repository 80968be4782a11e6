// SPDX-License-Identifier: Apache-2.0
// Where a virtual depth sensor stands and looks.
#pragma once

#include "ostraka/cloud/pinhole_camera.hpp"

namespace ostraka {

/// T_camera_world of a camera at `eye` that looks at `target`; `up` is up in its image.
/// `up` may be any vector: one that is parallel to the view is replaced.
Pose look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up = Vec3d::UnitZ());

}  // namespace ostraka
