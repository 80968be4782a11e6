// SPDX-License-Identifier: Apache-2.0
// Calibration of a library file, for all commands that do it.
#pragma once

#include <string>
#include <vector>

#include "ostraka/evaluation/calibration.hpp"

namespace ostraka::app {

struct CalibrationResult {
    ConfidenceModel confidence;
    std::vector<Example> examples;
    std::size_t right() const;  ///< how many of them were
};

/// Learns from simulated scenes how reports in scans of settings.kind are to be judged, and stores
/// the result in the file. Tells people.
CalibrationResult calibrate_library(const std::string& library,
                                    const CalibrationSettings& settings);

}  // namespace ostraka::app
