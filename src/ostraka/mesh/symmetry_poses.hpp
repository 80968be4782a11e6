// SPDX-License-Identifier: Apache-2.0
// What a symmetry means for poses: which are equivalent, and how far two are apart.
#pragma once

#include <string>
#include <vector>

#include "ostraka/mesh/symmetry.hpp"

namespace ostraka {

/// The place that all turns and axes leave where it is, or move least; of all such, the one closest
/// to the origin. The origin if there are none.
Vec3d symmetry_center(const std::vector<Pose>& turns, const std::vector<ContinuousAxis>& axes);

/// T_model_model of all symmetries, the identity first: every discrete one (or none) and then
/// `steps` equal turns about every continuous axis, as BOP's toolkit combines them (where a
/// sphere's three axes are united, not multiplied).
/// @param steps  in a full turn; BOP's own is ceil(pi / 0.01). Unused without a continuous axis.
/// @throws InvalidInput if steps is less than 1.
std::vector<Pose> symmetry_motions(const Symmetry& symmetry, int steps);

/// All poses that show the same surface: T_scene_model * S for the S of symmetry_motions(), the
/// pose itself first.
std::vector<Pose> equivalent_poses(const Symmetry& symmetry, const Pose& T_scene_model, int steps);

/// The pose equivalent to T_scene_model that is turned least against the reference; exact for
/// continuous axes. Of equals, the first in the order of equivalent_poses().
Pose nearest_equivalent_pose(const Symmetry& symmetry, const Pose& T_scene_model,
                             const Pose& T_scene_reference);

struct PoseDifference {
    double angle = 0.0;  ///< radians, 0 to pi
    double shift = 0.0;  ///< distance between the two places of the symmetry's center, model's unit
};

/// The smallest angle between any equivalents of two poses, and the shift of the center, which is
/// the same for all of them.
PoseDifference symmetric_difference(const Symmetry& symmetry, const Pose& T_scene_a,
                                    const Pose& T_scene_b);

/// Schoenflies' name of the group: "C1" (no symmetry), "C6", "D6", "T", "O", "I", "C-infinity",
/// "D-infinity" or "sphere". Turns that are no group, as a file may hold, are "other".
std::string symmetry_name(const Symmetry& symmetry);

/// The same in words: "6-fold about (0 0 1), and 6 half turns across", "none", ...
std::string describe_symmetry(const Symmetry& symmetry);

}  // namespace ostraka
