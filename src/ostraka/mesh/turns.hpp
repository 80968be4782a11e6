// SPDX-License-Identifier: Apache-2.0
// Rotations about lines, and the lines that motions turn about.
#pragma once

#include <span>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// A line that turns are about.
struct Line {
    Vec3d direction = Vec3d::UnitZ();  ///< unit length
    Vec3d point = Vec3d::Zero();       ///< on the line
};

Mat3d rotation_about(const Vec3d& direction, double angle);
Pose turn_about(const Line& line, double angle);
/// A rotation about `center`.
Pose turn_at(const Vec3d& center, const Mat3d& rotation);

/// The place that the motions move least; of all such, the one closest to the origin.
Vec3d fixed_point(std::span<const Pose> motions);

/// The axis of a motion, whose shift along it is left out, and its angle in [0, pi]. Of the points
/// on it, the one closest to the origin.
Line axis_of(const Pose& motion, double& angle);

}  // namespace ostraka
