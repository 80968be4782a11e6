// SPDX-License-Identifier: Apache-2.0
// How far a measured rate may be off.
// Efron, Tibshirani. An Introduction to the Bootstrap. 1993 (percentile intervals, chapter 13).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace ostraka {

struct Interval {
    double value = 0.0;  ///< of all scenes
    double low = 0.0;    ///< 2.5 % of the resampled values lie below
    double high = 0.0;   ///< 2.5 % lie above
};

/// sum(parts) / sum(wholes) with a 95 % interval: scenes are drawn with repetition, so that objects
/// of one scene, which are alike, count as one draw.
/// @param parts, wholes  a number a scene, of one length: hits and objects, right segments and all,
///                       or, for the difference of two rates, the difference of their hits.
/// @return zeros if the wholes sum to 0. The same for the same numbers and seed.
Interval bootstrap_ratio(std::span<const double> parts, std::span<const double> wholes,
                         std::uint64_t seed = 0, int draws = 2000);

/// The middle value, the upper one of two; 0 if there are none.
double median(std::vector<double> values);

/// The median of values with a 95 % interval. @return zeros if there are none.
Interval bootstrap_median(std::span<const double> values, std::uint64_t seed = 0, int draws = 2000);

}  // namespace ostraka
