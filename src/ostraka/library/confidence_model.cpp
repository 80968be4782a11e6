// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/confidence_model.hpp"

#include <cmath>

namespace ostraka {
namespace {

constexpr std::array<std::string_view, kFeatures> kNames = {
    "constant", "agreement", "clearness", "misfit", "excess", "turned",
    "visible",  "area",      "cells",     "grip",   "open",   "sunk"};

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
        .weights = {-7.1, -0.6, 4.8, -1.3, -5.5, 2.5, 5.0, 0.1, 2.2, 4.85, -10.8, -20.0}};
    return model;
}

}  // namespace ostraka
