// SPDX-License-Identifier: Apache-2.0
// Private to mesh: from measured turns, which are nearly symmetries, to an exact group.
#pragma once

#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// A line that turns are about.
struct Line {
    Vec3d direction = Vec3d::UnitZ();  ///< unit length
    Vec3d point = Vec3d::Zero();       ///< the one closest to the origin
};

Mat3d rotation_about(const Vec3d& direction, double angle);
Pose turn_about(const Line& line, double angle);
/// A rotation about `center`.
Pose turn_at(const Vec3d& center, const Mat3d& rotation);

/// The direction or its opposite: the one that points to positive z; else, if it is across z, to
/// positive y; else to positive x.
Vec3d upward(const Vec3d& direction);

/// The axis of a motion, whose shift along it is left out, and its angle in [0, pi].
Line axis_of(const Pose& motion, double& angle);

/// The place that the motions move least; of all such, the one closest to the origin.
Vec3d fixed_point(std::span<const Pose> motions);

/// The cyclic group of `order` turns about `main`, the identity first.
std::vector<Mat3d> cyclic_group(const Vec3d& main, int order);
/// The same and as many half turns across, one of them about `across`.
std::vector<Mat3d> dihedral_group(const Vec3d& main, const Vec3d& across, int order);
/// The group of 12, 24 or 60 turns that two turns nearly generate, exactly; empty if there is none.
std::vector<Mat3d> polyhedral_group(const Mat3d& first, const Mat3d& second);

}  // namespace ostraka
