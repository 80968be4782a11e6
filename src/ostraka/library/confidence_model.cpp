// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/confidence_model.hpp"

#include <cmath>

namespace ostraka {
namespace {

constexpr std::array<std::string_view, kFeatures> kNames = {
    "constant", "agreement", "clearness", "surplus", "turned", "visible", "area",
    "cells",    "grip",      "open",      "sunk",    "solid",  "rival"};

}  // namespace

std::string_view feature_name(Feature feature) {
    return kNames[static_cast<std::size_t>(feature)];
}

double ConfidenceModel::confidence(const Features& features) const {
    double logit = 0.0;
    for (std::size_t i = 0; i < kFeatures; ++i) logit += weights[i] * features[i];
    return 1.0 / (1.0 + std::exp(-logit));
}

const ConfidenceModel& general_confidence() {
    static const ConfidenceModel model{
        .weights = {-4.25, -2.45, 3.95, -2.3, -1.7, 0.8, 0.1, 3.7, 2.9, -19.7, -60.0, -1.2, -2.95}};
    return model;
}

// agreement and clearness are given, not learned: of what was learned from, the wrong ones came up
// because they agree.
const ConfidenceModel& merged_confidence() {
    static const ConfidenceModel model{
        .weights = {-4.7, 0.0, 2.0, -0.8, -17.5, 12.0, 1.5, -1.1, 4.7, 0.0, 0.0, 0.0, -1.7}};
    return model;
}

}  // namespace ostraka
