// SPDX-License-Identifier: Apache-2.0
// Internal to report: what charts share: title, axes, grid and a legend outside of the data.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "ostraka/report/plot_size.hpp"
#include "ostraka/report/svg_canvas.hpp"
#include "ostraka/report/ticks.hpp"

namespace ostraka {

struct LegendEntry {
    enum class Kind { kLine, kBar, kReference };
    std::string name;
    Kind kind = Kind::kLine;
    const Paint* paint = &kInk;
    std::size_t series = 0;  ///< decides marker and dashes
};

struct ChartFrame {
    std::string title, x_label, y_label;  ///< empty: no room is taken
    PlotSize size;
    PlotAxis y;
    std::vector<LegendEntry> legend;
    double headroom = 0.0;  ///< pixels above the area, for numbers on bars
    bool square = false;  ///< the area is as wide as high, and the drawing as wide as that asks for
};

/// Where things are, in pixels from the top left.
struct ChartLayout {
    double left = 0.0, right = 0.0;  ///< of the area that holds data
    double top = 0.0, bottom = 0.0;  ///< of the same
    double width = 0.0;              ///< of the whole drawing
    bool legend_right = false;       ///< else below
    std::vector<std::string> title;  ///< its lines

    double y(const PlotAxis& axis, double value) const {
        return bottom - (bottom - top) * axis.share(value);
    }
    double x(const PlotAxis& axis, double value) const {
        return left + (right - left) * axis.share(value);
    }
};

/// The dashes that tell the eighth series from the first, whose color it shares.
const char* series_dash(std::size_t series);

/// @throws InvalidInput if the size is out of range.
ChartLayout lay_out(const ChartFrame& frame);

/// Title, grid, labels of the y axis.
void draw_frame(SvgCanvas& canvas, const ChartFrame& frame, const ChartLayout& layout);

/// Ticks and labels of a numeric x axis. @return the height it takes below the area.
double draw_x_axis(SvgCanvas& canvas, const ChartLayout& layout, const PlotAxis& axis);

/// The x axis' name and the legend, and with them the drawing.
/// @param labels  the height that the x axis' labels take below the area.
std::string finish_chart(SvgCanvas& canvas, const ChartFrame& frame, const ChartLayout& layout,
                         double labels);

/// A drawing that says "no data".
std::string draw_no_data(std::string_view title, const PlotSize& size);

}  // namespace ostraka
