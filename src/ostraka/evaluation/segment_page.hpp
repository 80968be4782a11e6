// SPDX-License-Identifier: Apache-2.0
// Protocol S as a page to look at.
#pragma once

#include <string>
#include <vector>

#include "ostraka/evaluation/segments.hpp"
#include "ostraka/report/page.hpp"

namespace ostraka {

/// What one library made of the segments at one noise level.
struct SegmentRun {
    std::string library;    ///< its name
    double noise_mr = 0.0;  ///< standard deviation of depth, in mesh resolutions
    std::vector<SegmentTrial> trials;
};

/// Rates with intervals, gains over the first library, curves over noise, visible fraction and k,
/// and whom the last library takes for whom.
/// @param runs  all of the same segments at each noise; at least 1.
/// @param models  names. @param ks  as in SegmentSettings.
PageContent segment_page(std::span<const SegmentRun> runs, std::span<const std::string> models,
                         std::span<const std::size_t> ks);

/// "0.755 ±0.05", half of the interval's width; with a sign for differences.
std::string interval_text(const Interval& interval, bool sign = false);

}  // namespace ostraka
