// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/confidence_model.hpp"

#include <cmath>

namespace ostraka {
namespace {

constexpr std::array<std::string_view, kFeatures> kNames = {
    "constant", "clearness", "surplus", "turned", "visible", "area",   "cells",
    "grip",     "sharpness", "open",    "level",  "folded",  "joined", "fenced",
    "ended",    "sunk",      "solid",   "blank",  "hollow",  "rival"};

}  // namespace

std::string_view feature_name(Feature feature) {
    return kNames[static_cast<std::size_t>(feature)];
}

double ConfidenceModel::confidence(const Features& features) const {
    double logit = 0.0;
    for (std::size_t i = 0; i < kFeatures; ++i) logit += weights[i] * features[i];
    return 1.0 / (1.0 + std::exp(-logit));
}

// turned, visible, area and level tell nothing more. rival is what exclusion says, not fitted (left
// free it is -0.9). sunk and hollow are given: right reports hardly ever have them, so that any
// weight fits. So is joined: fitted it is -1 to -4, at which other weights only make up for it; at
// -8 a few wrong reports fewer, and as many right ones.
const ConfidenceModel& general_confidence() {
    static const ConfidenceModel model{.weights = {-6.89, 2.93,   -2.14,  0.0,   0.0,   0.0,  3.58,
                                                   2.79,  0.0,    -14.97, 0.0,   -39.3, -8.0, -3.82,
                                                   2.21,  -300.0, -2.78,  -0.47, -3.7,  -1.0}};
    return model;
}

// Nothing is known of outlines. turned grows with the noise, and tells nothing that sharpness
// doesn't; area nothing that visible doesn't. sunk is given, as above: no right report has any.
const ConfidenceModel& merged_confidence() {
    static const ConfidenceModel model{.weights = {-11.7, 2.95,   -4.97, 0.0, 6.44, 0.0, -0.4,
                                                   4.58,  13.65,  0.0,   0.0, 0.0,  0.0, 0.0,
                                                   0.0,   -300.0, -0.6,  0.0, 0.0,  -1.0}};
    return model;
}

}  // namespace ostraka
