// SPDX-License-Identifier: Apache-2.0
// What a report is worth: learned from simulated scenes of a library's own models. In every
// other scene a half or five sixths of the models are unknown. Platt. Probabilistic Outputs for
// Support Vector Machines and Comparisons to Regularized Likelihood Methods. 1999. Departs from the
// paper: several features instead of one score, and few examples leave the general weights as they
// are.
#pragma once

#include <span>
#include <vector>

#include "ostraka/base/progress.hpp"
#include "ostraka/library/model_library.hpp"

namespace ostraka {

struct CalibrationSettings {
    int scenes = 24;       ///< at least 1
    double prior = 32.0;   ///< how much the general weights count: larger, the less is learned.
                           ///< From 2 on log loss on other scenes is the same; a library of few
                           ///< models has few wrong reports to learn doubt from
    double max_adi = 0.1;  ///< pose error of a right report, in model diameters
    std::uint64_t seed = 0;
    ScanKind kind = ScanKind::one_viewpoint;  ///< how the scenes are given; merged: from nobody
                                              ///< knows where
};

/// What was reported in a simulated scene.
struct Example {
    Features features{};
    bool right = false;
};

/// Heaps on a table, in a bin, and objects one behind the other, with more and less noise.
/// @throws Interrupted.
std::vector<Example> calibration_examples(const ModelLibrary& library,
                                          const CalibrationSettings& settings,
                                          const Progress& progress = {});

/// The logistic function that fits the examples best, held to `from` by a Gaussian prior of
/// precision `prior` on each weight and on the logit of what is average. The same bytes on every
/// run.
ConfidenceModel fit_confidence(std::span<const Example> examples, const ConfidenceModel& from,
                               double prior);

}  // namespace ostraka
