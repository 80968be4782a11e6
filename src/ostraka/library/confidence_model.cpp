// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/confidence_model.hpp"

#include <cmath>

namespace ostraka {
namespace {

constexpr std::array<std::string_view, kFeatures> kNames = {
    "constant", "agreement", "clearness", "surplus", "turned", "visible",
    "area",     "cells",     "grip",      "open",    "sunk",   "solid"};

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
        .weights = {-4.15, -4.05, 4.1, -1.95, -2.55, 3.8, -0.1, 3.1, 3.9, -14.5, -11.4, -0.95}};
    return model;
}

}  // namespace ostraka
