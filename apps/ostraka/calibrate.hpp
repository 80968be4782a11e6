// SPDX-License-Identifier: Apache-2.0
// Calibration of a library file, for all commands that do it.
#pragma once

#include <string>

#include "ostraka/evaluation/calibration.hpp"

namespace ostraka::app {

struct CalibrationResult {
    ConfidenceModel confidence;
    std::size_t examples = 0;
    std::size_t right = 0;
};

/// Learns from simulated scenes and stores the result in the file. Tells people.
CalibrationResult calibrate_library(const std::string& library,
                                    const CalibrationSettings& settings);

}  // namespace ostraka::app
