// SPDX-License-Identifier: Apache-2.0
// Poses against a scan that was merged of several: surface may be known from all sides, and a
// direction has no single measurement. Support is looked for in space; only known viewpoints can
// contradict.
#pragma once

#include "ostraka/recognition/verification.hpp"

namespace ostraka {

/// As gather_evidence(); a sample without surface near it is `missing`, or a `violation` where one
/// of the scan's views looked through it.
Evidence gather_merged_evidence(const Scan& scan, const ModelProbe& probe,
                                const Pose& T_scene_model, double tolerance, std::size_t samples);

/// As verify(), of points of the model's surface instead of cells: Verified::cells are points of
/// the scan, and what supports is compared with all that lies about the model's surface:
/// Verified::violation also counts points beside it.
Verified verify_merged(const Scan& scan, const ModelProbe& probe, const Hypothesis& hypothesis,
                       double tolerance);

}  // namespace ostraka
