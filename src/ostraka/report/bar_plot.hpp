// SPDX-License-Identifier: Apache-2.0
// Grouped bars: a number for each of several methods on each of several data sets.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ostraka/report/plot_size.hpp"

namespace ostraka {

struct BarSeries {
    std::string name;               ///< in the legend; empty: not there
    std::vector<double> values;     ///< one a group; not finite: no bar
    std::vector<double> low, high;  ///< ends of the intervals, one a group; both empty: none
};

/// A dashed line across the plot: a published result, a limit.
struct ReferenceLine {
    std::string name;  ///< in the legend
    double value = 0.0;
    std::optional<std::size_t> series;  ///< drawn in that series' color; none: gray
};

struct BarPlot {
    std::string title;
    std::string y_label;              ///< with the unit, if there is one
    std::vector<std::string> groups;  ///< names under the bars
    std::vector<BarSeries> series;
    std::vector<ReferenceLine> references;
    std::optional<std::pair<double, double>> y_range;  ///< none: from the data, with 0 in it
    bool percent = false;                              ///< labels: 0.5 as "50 %"
    PlotSize size = {};
};

/// The plot as one <svg> element. Bars wide enough carry their number; names too long for their
/// place are broken into two lines or turned.
/// @throws InvalidInput if a series has not one value a group or the size is out of range.
std::string draw_svg(const BarPlot& plot);

}  // namespace ostraka
