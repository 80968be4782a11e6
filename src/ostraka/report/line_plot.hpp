// SPDX-License-Identifier: Apache-2.0
// Lines over a number: a rate against occlusion, precision against recall, reliability.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ostraka/report/plot_size.hpp"

namespace ostraka {

struct PlotSeries {
    std::string name;               ///< in the legend; empty: not there
    std::vector<double> x;          ///< joined in this order, which need not ascend
    std::vector<double> y;          ///< as many as x; a point that isn't finite leaves a gap
    std::vector<double> low, high;  ///< ends of y's interval, as many as x; both empty: none.
                                    ///< Whiskers, or a band if there are more than 12 points.
};

struct LinePlot {
    std::string title;
    std::string x_label, y_label;  ///< with the unit, if there is one
    std::vector<PlotSeries> series;
    std::optional<std::pair<double, double>> x_range, y_range;  ///< none: from the data
    bool percent_x = false, percent_y = false;                  ///< labels: 0.5 as "50 %"
    bool diagonal = false;  ///< a square with the line y = x, for reliability diagrams
    PlotSize size = {};
};

/// The plot as one <svg> element, to be put in a page or saved as a file of its own. Points outside
/// of a given range aren't shown.
/// @throws InvalidInput if a series' arrays differ in length or the size is out of range.
std::string draw_svg(const LinePlot& plot);

}  // namespace ostraka
