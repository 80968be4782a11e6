// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/matrix_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "ostraka/base/error.hpp"
#include "ostraka/report/chart_frame.hpp"
#include "ostraka/report/label_text.hpp"
#include "ostraka/report/markup.hpp"

namespace ostraka {
namespace {

constexpr double kMostName = 180.0;  // pixels
constexpr double kSmallCell = 26.0;  // in smaller ones zeros would be clutter
constexpr double kLabelSize = 12.0;
constexpr double kTitleSize = 14.0;
constexpr double kTitleHeight = 28.0;

struct Grid {
    double left = 0.0, top = 0.0;  // of the first cell
    double cell = 0.0;             // pixels a side
    double name_size = 0.0;        // font
    double number_size = 0.0;
    bool turned = true;  // the columns' names
    double width = 0.0, height = 0.0;
};

double widest(const std::vector<std::string>& names, double size) {
    double width = 0.0;
    for (const std::string& name : names) width = std::max(width, label_width(name, size));
    return std::min(width, kMostName);
}

std::string number_of(const MatrixPlot& plot, double value) {
    if (!plot.counts) return fmt::format("{:.0f}", std::clamp(100.0 * value, -1e6, 1e6));
    return tick_label(value, value == std::round(value) ? 1.0 : 0.1, false);
}

double widest_number(const MatrixPlot& plot) {
    double width = 0.5;
    for (const double value : plot.values) {
        if (is_plottable(value)) width = std::max(width, label_width(number_of(plot, value), 1.0));
    }
    return width;
}

Grid make_grid(const MatrixPlot& plot) {
    const double count = double(std::max(plot.columns.size(), plot.rows.size()));
    Grid grid;
    grid.cell = std::clamp((kWholePlot - kMostName - 40.0) / count, 10.0, 44.0);
    grid.name_size = std::clamp(grid.cell - 4.0, 7.0, kLabelSize);
    // Numbers keep a pixel from the cell's border.
    const double fitting = (grid.cell - 2.0) / widest_number(plot);
    grid.number_size = std::min({fitting, 0.62 * grid.cell, kLabelSize});
    const double axis_name = plot.row_label.empty() ? 0.0 : 22.0;
    grid.left = axis_name + widest(plot.rows, grid.name_size) + 8.0;
    const double across = widest(plot.columns, grid.name_size);
    grid.turned = across > grid.cell - 2.0;
    grid.top = (plot.title.empty() ? 4.0 : kTitleHeight) +
               (plot.column_label.empty() ? 0.0 : 22.0) + (grid.turned ? across : grid.name_size) +
               8.0;
    const double right = grid.left + grid.cell * double(plot.columns.size());
    grid.width = std::max(right + 4.0, 300.0);
    grid.height = grid.top + grid.cell * double(plot.rows.size());
    return grid;
}

// Share of the row's sum, or the value itself: 0 to 1.
std::vector<double> cell_shades(const MatrixPlot& plot) {
    const std::size_t columns = plot.columns.size();
    std::vector<double> shades(plot.values.size(), 0.0);
    for (std::size_t r = 0; r < plot.rows.size(); ++r) {
        double sum = plot.counts ? 0.0 : 1.0;
        for (std::size_t c = 0; plot.counts && c < columns; ++c) {
            const double value = plot.values[r * columns + c];
            if (is_plottable(value)) sum += std::max(value, 0.0);
        }
        for (std::size_t c = 0; c < columns; ++c) {
            const double value = plot.values[r * columns + c];
            if (!is_plottable(value) || !(sum > 0.0)) continue;
            shades[r * columns + c] = std::clamp(value / sum, 0.0, 1.0);
        }
    }
    return shades;
}

bool names_agree(const MatrixPlot& plot) {
    for (const std::string& row : plot.rows) {
        if (std::find(plot.columns.begin(), plot.columns.end(), row) != plot.columns.end()) {
            return true;
        }
    }
    return false;
}

// A text is dark or light, whichever stands out from the cell, in each scheme by itself: "tl" and
// "td" switch it from the scheme's ink to the inverse in the light and in the dark scheme.
const char* number_classes(const Paint& fill, double opacity, bool& inverse_light) {
    const Color light = blend(kPaper.light, fill.light, opacity);
    const Color dark = blend(kPaper.dark, fill.dark, opacity);
    inverse_light = contrast(light, kInverse.light) > contrast(light, kInk.light);
    const bool inverse_dark = contrast(dark, kInverse.dark) > contrast(dark, kInk.dark);
    constexpr const char* kClasses[] = {"", "td", "tl", "tl td"};
    return kClasses[(inverse_light ? 2 : 0) + (inverse_dark ? 1 : 0)];
}

void draw_cell(SvgCanvas& canvas, const MatrixPlot& plot, const Grid& grid, std::size_t r,
               std::size_t c, double shade, bool agree) {
    const double value = plot.values[r * plot.columns.size() + c];
    const Paint& fill = agree ? series_paint(0) : series_paint(1);
    const Dot corner{grid.left + grid.cell * double(c), grid.top + grid.cell * double(r)};
    // The lightest shade still differs from an empty cell.
    const double opacity = shade > 0.0 ? 0.1 + 0.9 * shade : 0.0;
    if (opacity > 0.0) {
        canvas.rectangle(
            {corner.x + 0.5, corner.y + 0.5}, grid.cell - 1.0, grid.cell - 1.0, fill, opacity,
            fmt::format("{} \xE2\x86\x92 {}: {}", plot.rows[r], plot.columns[c],
                        plot.counts ? value_label(value, false) : value_label(value, true)));
    }
    if (!is_plottable(value) || (value == 0.0 && grid.cell < kSmallCell)) return;
    bool inverse = false;
    TextStyle style{grid.number_size, &kInk, TextAnchor::kMiddle};
    style.classes = number_classes(fill, opacity, inverse);
    if (value == 0.0) style.paint = &kQuiet;
    // Alone, without a page's style, the light scheme's choice holds.
    if (inverse) style.paint = &kInverse;
    canvas.text({corner.x + 0.5 * grid.cell, corner.y + 0.5 * grid.cell}, number_of(plot, value),
                style);
}

void draw_name(SvgCanvas& canvas, const std::string& name, Dot at, TextStyle style) {
    const std::string shown = shortened_label(name, style.size, kMostName);
    if (shown != name) style.hint = name;
    canvas.text(at, shown, style);
}

void draw_names(SvgCanvas& canvas, const MatrixPlot& plot, const Grid& grid) {
    for (std::size_t r = 0; r < plot.rows.size(); ++r) {
        draw_name(canvas, plot.rows[r], {grid.left - 6.0, grid.top + grid.cell * (double(r) + 0.5)},
                  {grid.name_size, &kInk, TextAnchor::kEnd});
    }
    for (std::size_t c = 0; c < plot.columns.size(); ++c) {
        TextStyle style{grid.name_size, &kInk};
        if (grid.turned) {
            style.turn = -90.0;
        } else {
            style.anchor = TextAnchor::kMiddle;
        }
        const double above = grid.turned ? 6.0 : 4.0 + 0.5 * grid.name_size;
        draw_name(canvas, plot.columns[c],
                  {grid.left + grid.cell * (double(c) + 0.5), grid.top - above}, style);
    }
}

void draw_labels(SvgCanvas& canvas, const MatrixPlot& plot, const Grid& grid) {
    if (!plot.title.empty()) {
        canvas.text({0.0, 9.0}, shortened_label(plot.title, kTitleSize, grid.width),
                    {.size = kTitleSize, .bold = true});
    }
    if (!plot.column_label.empty()) {
        const double y = (plot.title.empty() ? 4.0 : kTitleHeight) + 8.0;
        canvas.text({grid.left, y},
                    shortened_label(plot.column_label, kLabelSize, grid.width - grid.left),
                    {.size = kLabelSize, .paint = &kQuiet});
    }
    if (!plot.row_label.empty()) {
        TextStyle style{kLabelSize, &kQuiet, TextAnchor::kEnd};
        style.turn = -90.0;
        const double room = std::max(grid.height - grid.top, 100.0);
        canvas.text({8.0, grid.top}, shortened_label(plot.row_label, kLabelSize, room), style);
    }
}

void draw_lines(SvgCanvas& canvas, const MatrixPlot& plot, const Grid& grid) {
    const double right = grid.left + grid.cell * double(plot.columns.size());
    for (std::size_t r = 0; r <= plot.rows.size(); ++r) {
        const double y = grid.top + grid.cell * double(r);
        canvas.line({grid.left, y}, {right, y}, {&kGrid});
    }
    for (std::size_t c = 0; c <= plot.columns.size(); ++c) {
        const double x = grid.left + grid.cell * double(c);
        canvas.line({x, grid.top}, {x, grid.height}, {&kGrid});
    }
}

}  // namespace

std::string draw_svg(const MatrixPlot& plot) {
    if (plot.values.size() != plot.rows.size() * plot.columns.size()) {
        throw InvalidInput(fmt::format("plot: {} values for {} x {} cells", plot.values.size(),
                                       plot.rows.size(), plot.columns.size()));
    }
    if (plot.values.empty()) return draw_no_data(plot.title, {});
    const Grid grid = make_grid(plot);
    const std::vector<double> shades = cell_shades(plot);
    const bool confusion = names_agree(plot);
    SvgCanvas canvas;
    draw_labels(canvas, plot, grid);
    draw_lines(canvas, plot, grid);
    draw_names(canvas, plot, grid);
    for (std::size_t r = 0; r < plot.rows.size(); ++r) {
        for (std::size_t c = 0; c < plot.columns.size(); ++c) {
            const bool agree = !confusion || plot.rows[r] == plot.columns[c];
            draw_cell(canvas, plot, grid, r, c, shades[r * plot.columns.size() + c], agree);
        }
    }
    return canvas.svg(grid.width, grid.height + 4.0, plot.title);
}

}  // namespace ostraka
