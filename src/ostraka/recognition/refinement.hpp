// SPDX-License-Identifier: Apache-2.0
// Coarse to fine: many poses are scored, the best refined roughly, the best of those finely.
#pragma once

#include "ostraka/recognition/hypothesis.hpp"

namespace ostraka {

/// Aligns the model at a pose with the scan's points around it.
/// @param max_points  points of the scan used.
/// @param reach       distance within which model and scan are paired at first, scan's unit.
Pose refine_pose(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model,
                 std::size_t max_points, double reach);

/// The best few poses of one model, refined, best first, no two of them nearly equal.
std::vector<Hypothesis> refine_hypotheses(const Scan& scan, const ModelProbe& probe,
                                          std::vector<Hypothesis> hypotheses,
                                          const RecognitionSettings& settings);

}  // namespace ostraka
