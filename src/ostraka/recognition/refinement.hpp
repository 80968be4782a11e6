// SPDX-License-Identifier: Apache-2.0
// From thousands of guesses to a few exact poses (method, 3.5): cheap looks at all, coarse
// registration of some, fine registration of the best.
#pragma once

#include "ostraka/recognition/hypothesis.hpp"

namespace ostraka {

/// Registers the scan's points around a placed model, but those that another object explains, with
/// the model's surface.
/// @param max_points  used, thinned out evenly. @param reach  of the first step, scan's unit.
Pose refine_pose(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model,
                 std::size_t max_points, double reach);

/// As refine_pose(), for the last digits of a pose that is nearly right.
Pose refine_finely(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model);

/// As refine_pose(), for a guess that may be 15 degrees and a tenth of the diameter off. From there
/// even the right partners on boxes face elsewhere, but most wrong partners do, too: for models
/// with flat faces it goes both ways, with and without regard for that, and takes the one that fits
/// the scan better.
/// @param tolerance  of quick_score(), scan's unit.
Pose refine_from_afar(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model,
                      double tolerance);

/// Whether two poses of a model move its surface less than `distance` against each other.
bool nearly_equal(const Pose& a, const Pose& b, const MeshShape& shape, double distance);

/// The poses of one model that are worth verifying, refined; best quick_score() first.
std::vector<Hypothesis> refine_hypotheses(const Scan& scan, const ModelProbe& probe,
                                          std::vector<Hypothesis> hypotheses,
                                          const RecognitionSettings& settings);

}  // namespace ostraka
