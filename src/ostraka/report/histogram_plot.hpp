// SPDX-License-Identifier: Apache-2.0
// How one measured quantity is distributed: position errors, times, confidences.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ostraka/report/bar_plot.hpp"

namespace ostraka {

struct HistogramPlot {
    std::string title;
    std::string x_label;  ///< with the unit, if there is one
    std::string y_label = "count";
    std::vector<double> values;                        ///< any order; what isn't finite is left out
    std::vector<ReferenceLine> references;             ///< at places of x: a median, a threshold
    std::optional<std::pair<double, double>> x_range;  ///< none: all values. How many lie outside
                                                       ///< is said beside the axis' label.
    bool percent_x = false;                            ///< labels: 0.5 as "50 %"
    int bins = 0;  ///< about so many, as steps are round; 0: 2 n^(1/3), from 5 to 40
    PlotSize size = {};
};

/// The plot as one <svg> element.
/// @throws InvalidInput if the size is out of range or bins aren't 0 to 1000.
std::string draw_svg(const HistogramPlot& plot);

}  // namespace ostraka
