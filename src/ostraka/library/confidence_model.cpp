// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/confidence_model.hpp"

#include <cmath>

namespace ostraka {
namespace {

constexpr std::array<std::string_view, kFeatures> kNames = {
    "constant", "agreement", "clearness", "misfit", "excess", "turned", "visible",
    "area",     "cells",     "grip",      "open",   "sunk",   "solid"};

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
        .weights = {-5.6, -1.5, 3.6, -1.15, -6.6, 2.8, 5.1, 0.2, 2.4, 5.0, -12.2, -20.0, -1.9}};
    return model;
}

}  // namespace ostraka
