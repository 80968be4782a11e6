// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/confidence_model.hpp"

#include <cmath>

namespace ostraka {
namespace {

constexpr std::array<std::string_view, kFeatures> kNames = {
    "constant", "clearness", "surplus", "turned", "visible", "area",  "cells", "grip",
    "open",     "level",     "folded",  "ended",  "sunk",    "solid", "rival"};

}  // namespace

std::string_view feature_name(Feature feature) {
    return kNames[static_cast<std::size_t>(feature)];
}

double ConfidenceModel::confidence(const Features& features) const {
    double logit = 0.0;
    for (std::size_t i = 0; i < kFeatures; ++i) logit += weights[i] * features[i];
    return 1.0 / (1.0 + std::exp(-logit));
}

// turned, visible and area tell nothing more where the outline is known. sunk is given: hardly any
// example has it.
const ConfidenceModel& general_confidence() {
    static const ConfidenceModel model{.weights = {-8.1, 5.4, -1.35, 0.0, 0.0, 0.0, 2.65, 2.0,
                                                   -10.2, -1.7, -18.1, 1.8, -60.0, -0.87, -1.9}};
    return model;
}

// Nothing is known of outlines; clearness told nothing.
const ConfidenceModel& merged_confidence() {
    static const ConfidenceModel model{.weights = {-6.1, 0.0, -1.9, -19.6, 3.65, 1.9, -0.7, 4.3,
                                                   0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -2.75}};
    return model;
}

}  // namespace ostraka
