// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/line_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "ostraka/base/error.hpp"
#include "ostraka/report/chart_frame.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kMostWhiskers = 12;  // more run into each other: a band
constexpr std::size_t kMostMarkers = 40;

struct Axes {
    PlotAxis x, y;
};

void check(const PlotSeries& series) {
    const std::size_t count = series.x.size();
    const bool plain = series.low.empty() && series.high.empty();
    if (series.y.size() != count ||
        (!plain && (series.low.size() != count || series.high.size() != count))) {
        throw InvalidInput(fmt::format("plot: series \"{}\" has {} x, {} y, {} low, {} high",
                                       series.name, count, series.y.size(), series.low.size(),
                                       series.high.size()));
    }
}

bool has_point(const PlotSeries& series, std::size_t i) {
    return is_plottable(series.x[i]) && is_plottable(series.y[i]);
}

bool has_interval(const PlotSeries& series, std::size_t i) {
    return !series.low.empty() && has_point(series, i) && is_plottable(series.low[i]) &&
           is_plottable(series.high[i]);
}

// Runs of consecutive points for which `holds` is true: [begin, end).
template <typename Predicate>
std::vector<std::pair<std::size_t, std::size_t>> runs(std::size_t count, Predicate holds) {
    std::vector<std::pair<std::size_t, std::size_t>> found;
    for (std::size_t i = 0; i < count; ++i) {
        if (!holds(i)) continue;
        if (found.empty() || found.back().second != i) found.emplace_back(i, i);
        found.back().second = i + 1;
    }
    return found;
}

Axes make_axes(const LinePlot& plot, PlotRange x, PlotRange y) {
    if (plot.diagonal && !plot.x_range && !plot.y_range) {
        x.include(y.low);
        x.include(y.high);
        y = x;
    }
    return {make_axis(x, plot.x_range, plot.percent_x, plot.diagonal ? 5 : 6),
            make_axis(y, plot.y_range, plot.percent_y)};
}

// A place on the drawing, kept near enough for SVG's numbers; the clip hides what is outside.
Dot place(const ChartLayout& layout, const Axes& axes, double x, double y) {
    return {std::clamp(layout.x(axes.x, x), -1e5, 1e5), std::clamp(layout.y(axes.y, y), -1e5, 1e5)};
}

void append(std::string& path, char command, Dot at) {
    fmt::format_to(std::back_inserter(path), "{}{} {}", command, pixels(at.x), pixels(at.y));
}

void draw_band(SvgCanvas& canvas, const ChartLayout& layout, const Axes& axes,
               const PlotSeries& series, const Paint& paint) {
    const auto holds = [&](std::size_t i) { return has_interval(series, i); };
    std::string path;
    for (const auto& [begin, end] : runs(series.x.size(), holds)) {
        for (std::size_t i = begin; i < end; ++i) {
            append(path, i == begin ? 'M' : 'L', place(layout, axes, series.x[i], series.high[i]));
        }
        for (std::size_t i = end; i-- > begin;) {
            append(path, 'L', place(layout, axes, series.x[i], series.low[i]));
        }
        path += 'Z';
    }
    if (!path.empty()) canvas.shape(path, paint, 0.18);
}

void draw_whiskers(SvgCanvas& canvas, const ChartLayout& layout, const Axes& axes,
                   const PlotSeries& series, const Paint& paint) {
    std::string path;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        if (!has_interval(series, i)) continue;
        const Dot low = place(layout, axes, series.x[i], series.low[i]);
        const Dot high = place(layout, axes, series.x[i], series.high[i]);
        for (const Dot& end : {low, high}) {
            append(path, 'M', {end.x - 3.5, end.y});
            append(path, 'L', {end.x + 3.5, end.y});
        }
        append(path, 'M', low);
        append(path, 'L', high);
    }
    if (!path.empty()) canvas.outline(path, {&paint, 1.25});
}

void draw_line(SvgCanvas& canvas, const ChartLayout& layout, const Axes& axes,
               const PlotSeries& series, std::size_t number) {
    const auto holds = [&](std::size_t i) { return has_point(series, i); };
    std::string path;
    for (const auto& [begin, end] : runs(series.x.size(), holds)) {
        if (end - begin < 2) continue;
        for (std::size_t i = begin; i < end; ++i) {
            append(path, i == begin ? 'M' : 'L', place(layout, axes, series.x[i], series.y[i]));
        }
    }
    if (!path.empty()) {
        canvas.outline(path, {&series_paint(number), 2.0, series_dash(number)});
    }
}

std::string point_hint(const LinePlot& plot, const PlotSeries& series, std::size_t i) {
    std::string hint = fmt::format("{}{}{}: {}", series.name, series.name.empty() ? "" : ", ",
                                   value_label(series.x[i], plot.percent_x),
                                   value_label(series.y[i], plot.percent_y));
    if (has_interval(series, i)) {
        hint += fmt::format(" ({} to {})", value_label(series.low[i], plot.percent_y),
                            value_label(series.high[i], plot.percent_y));
    }
    return hint;
}

void draw_markers(SvgCanvas& canvas, const ChartLayout& layout, const Axes& axes,
                  const LinePlot& plot, std::size_t number) {
    const PlotSeries& series = plot.series[number];
    const std::size_t count = series.x.size();
    const auto inside = [](const PlotAxis& axis, double value) {
        return axis.share(value) > -1e-6 && axis.share(value) < 1.0 + 1e-6;
    };
    for (std::size_t i = 0; i < count; ++i) {
        if (!has_point(series, i)) continue;
        const bool alone =
            !(i > 0 && has_point(series, i - 1)) && !(i + 1 < count && has_point(series, i + 1));
        if (count > kMostMarkers && !alone) continue;
        if (!inside(axes.x, series.x[i]) || !inside(axes.y, series.y[i])) continue;
        const Dot at = place(layout, axes, series.x[i], series.y[i]);
        canvas.shape(marker_path(number, at, 3.6), series_paint(number), 1.0, 1.0,
                     point_hint(plot, series, i));
    }
}

void draw_data(SvgCanvas& canvas, const ChartLayout& layout, const Axes& axes,
               const LinePlot& plot) {
    constexpr double kBorder = 1.5;  // so that lines along the edge keep their width
    canvas.begin_clip({layout.left - kBorder, layout.top - kBorder},
                      layout.right - layout.left + 2.0 * kBorder,
                      layout.bottom - layout.top + 2.0 * kBorder);
    if (plot.diagonal) {
        const double low = std::min(axes.x.low, axes.y.low);
        const double high = std::max(axes.x.high, axes.y.high);
        canvas.line(place(layout, axes, low, low), place(layout, axes, high, high),
                    {&kAxisLine, 1.25, "4 4"});
    }
    for (std::size_t s = 0; s < plot.series.size(); ++s) {
        const PlotSeries& series = plot.series[s];
        const bool band = series.x.size() > kMostWhiskers;
        (band ? draw_band : draw_whiskers)(canvas, layout, axes, series, series_paint(s));
    }
    for (std::size_t s = 0; s < plot.series.size(); ++s) {
        draw_line(canvas, layout, axes, plot.series[s], s);
    }
    canvas.end_clip();
    for (std::size_t s = 0; s < plot.series.size(); ++s) {
        draw_markers(canvas, layout, axes, plot, s);
    }
}

}  // namespace

std::string draw_svg(const LinePlot& plot) {
    PlotRange x;
    PlotRange y;
    ChartFrame frame{plot.title, plot.x_label, plot.y_label, plot.size};
    for (std::size_t s = 0; s < plot.series.size(); ++s) {
        const PlotSeries& series = plot.series[s];
        check(series);
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            if (!has_point(series, i)) continue;
            x.include(series.x[i]);
            y.include(series.y[i]);
            if (!has_interval(series, i)) continue;
            y.include(series.low[i]);
            y.include(series.high[i]);
        }
        if (!series.name.empty()) {
            frame.legend.push_back({series.name, LegendEntry::Kind::kLine, &series_paint(s), s});
        }
    }
    if (x.empty) return draw_no_data(plot.title, plot.size);
    const Axes axes = make_axes(plot, x, y);
    frame.y = axes.y;
    frame.square = plot.diagonal;
    const ChartLayout layout = lay_out(frame);
    SvgCanvas canvas;
    draw_frame(canvas, frame, layout);
    const double labels = draw_x_axis(canvas, layout, axes.x);
    draw_data(canvas, layout, axes, plot);
    return finish_chart(canvas, frame, layout, labels);
}

}  // namespace ostraka
