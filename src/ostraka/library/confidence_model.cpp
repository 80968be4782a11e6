// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/confidence_model.hpp"

#include <cmath>

namespace ostraka {
namespace {

constexpr std::array<std::string_view, kFeatures> kNames = {
    "constant", "agreement", "good_agreement", "misfit", "excess", "turned",
    "visible",  "area",      "cells",          "grip",   "open",   "sunk"};

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
        .weights = {-9.0, 3.5, 7.5, -0.6, -6.4, 3.4, 3.8, 0.1, 2.7, 4.8, -11.9, -2.6}};
    return model;
}

}  // namespace ostraka
