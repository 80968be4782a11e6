// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/confidence.hpp"

#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr std::size_t kMinSupport = 40;  // cells
constexpr double kHardlyVisible = 0.01;
constexpr double kEnoughVisible = 0.5;
constexpr double kMostSurplus = 2.0;
constexpr double kLeastNoise = 0.1;  // sampling distances

}  // namespace

bool too_small(const Verified& verified) {
    return verified.support < kMinSupport;
}

Features features_of(const Verified& v) {
    Features features{};
    const auto set = [&](Feature feature, double value) {
        features[static_cast<std::size_t>(feature)] = value;
    };
    const double cells = static_cast<double>(v.support) / static_cast<double>(kMinSupport);
    set(Feature::constant, 1.0);
    const double noise = std::clamp(v.noise, kLeastNoise, 1.0);
    set(Feature::clearness, std::pow(v.agreement(), std::pow(noise, -1.5)));
    // Nothing is expected of what has no support.
    const double surplus = v.expected_rms > 0.0 ? v.inlier_rms / v.expected_rms - 1.0 : 0.0;
    set(Feature::surplus, std::clamp(surplus, 0.0, kMostSurplus));
    set(Feature::turned, v.turned);
    set(Feature::visible,
        std::log10(100.0 * std::clamp(v.visible_fraction, kHardlyVisible, kEnoughVisible)));
    set(Feature::area, std::log10(1.0 + 100.0 * v.area));
    set(Feature::cells, std::log10(1.0 + cells));
    set(Feature::grip, std::sqrt(v.grip));
    set(Feature::sharpness, v.sharpness);
    set(Feature::open, v.outline.open);
    set(Feature::level, v.outline.level);
    set(Feature::folded, v.outline.folded);
    set(Feature::joined, v.outline.joined);
    set(Feature::fenced, std::max(0.0, v.outline.fenced - kOftenFenced));
    set(Feature::ended, std::log10(1.0 + v.outline.ended));
    set(Feature::sunk, v.sunk);
    set(Feature::solid, std::log10(1.0 + static_cast<double>(v.solid + v.inside)));
    set(Feature::blank, std::log10(1.0 + static_cast<double>(v.blank)));
    set(Feature::hollow, std::log10(1.0 + static_cast<double>(v.hollow)));
    return features;
}

}  // namespace ostraka
