// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/bar_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/report/chart_frame.hpp"
#include "ostraka/report/label_text.hpp"

namespace ostraka {
namespace {

constexpr double kNameSize = 11.5;
constexpr double kNameLine = 14.0;
constexpr double kNumberSize = 11.0;
constexpr double kNumberGap = 9.0;  // from a bar's end to its number's middle
constexpr double kNumberRoom = 14.0;
constexpr double kMostTurned = 130.0;  // pixels of a turned name
constexpr double kMostBar = 64.0;      // a wider bar looks like an area

// Where bars stand: a slot a group, of which the bars take the middle.
struct Slots {
    double first = 0.0;  // left edge of the first
    double width = 0.0;
    double bar = 0.0;  // width of one bar
    std::size_t series = 1;

    double middle(std::size_t group) const { return first + width * (double(group) + 0.5); }
    double left(std::size_t group, std::size_t s) const {
        return middle(group) + bar * (double(s) - 0.5 * double(series));
    }
};

void check(const BarPlot& plot) {
    const std::size_t groups = plot.groups.size();
    for (const BarSeries& series : plot.series) {
        const bool plain = series.low.empty() && series.high.empty();
        if (series.values.size() != groups ||
            (!plain && (series.low.size() != groups || series.high.size() != groups))) {
            throw InvalidInput(fmt::format(
                "plot: series \"{}\" has {} values, {} low, {} high for {} groups", series.name,
                series.values.size(), series.low.size(), series.high.size(), groups));
        }
    }
}

bool has_interval(const BarSeries& series, std::size_t g) {
    return !series.low.empty() && is_plottable(series.low[g]) && is_plottable(series.high[g]);
}

PlotRange data_range(const BarPlot& plot) {
    PlotRange range;
    for (const BarSeries& series : plot.series) {
        for (std::size_t g = 0; g < plot.groups.size(); ++g) {
            if (!is_plottable(series.values[g])) continue;
            range.include(series.values[g]);
            if (!has_interval(series, g)) continue;
            range.include(series.low[g]);
            range.include(series.high[g]);
        }
    }
    if (range.empty) return range;
    range.include(0.0);
    for (const ReferenceLine& line : plot.references) range.include(line.value);
    return range;
}

std::vector<LegendEntry> make_legend(const BarPlot& plot) {
    std::vector<LegendEntry> legend;
    for (std::size_t s = 0; s < plot.series.size(); ++s) {
        if (plot.series[s].name.empty()) continue;
        legend.push_back({plot.series[s].name, LegendEntry::Kind::kBar, &series_paint(s), s});
    }
    for (const ReferenceLine& line : plot.references) {
        if (!is_plottable(line.value) || line.name.empty()) continue;
        const Paint* paint = line.series ? &series_paint(*line.series) : &kQuiet;
        legend.push_back({line.name, LegendEntry::Kind::kReference, paint, 0});
    }
    return legend;
}

Slots make_slots(const BarPlot& plot, const ChartLayout& layout) {
    Slots slots;
    slots.first = layout.left;
    slots.width = (layout.right - layout.left) / double(plot.groups.size());
    slots.series = plot.series.size();
    slots.bar = std::min(0.78 * slots.width / double(slots.series), kMostBar);
    return slots;
}

struct Bar {
    double left = 0.0, width = 0.0;
    double zero = 0.0, end = 0.0;  // y of its foot and of its value
    double low = 0.0, high = 0.0;  // y of its interval's ends; the value's if there is none
};

Bar make_bar(const BarPlot& plot, const ChartLayout& layout, const PlotAxis& axis,
             const Slots& slots, std::size_t s, std::size_t g) {
    const BarSeries& series = plot.series[s];
    // A bar that leaves a given range ends at its border.
    const auto y = [&](double value) {
        return std::clamp(layout.y(axis, value), layout.top, layout.bottom);
    };
    const double gap = slots.bar > 6.0 ? 1.0 : 0.0;
    Bar bar;
    bar.left = slots.left(g, s) + 0.5 * gap;
    bar.width = slots.bar - gap;
    bar.zero = y(0.0);
    bar.end = y(series.values[g]);
    const bool interval = has_interval(series, g);
    bar.low = interval ? y(series.low[g]) : bar.end;
    bar.high = interval ? y(series.high[g]) : bar.end;
    return bar;
}

std::string bar_hint(const BarPlot& plot, std::size_t s, std::size_t g) {
    const BarSeries& series = plot.series[s];
    std::string hint = fmt::format("{}{}{}: {}", plot.groups[g], series.name.empty() ? "" : ", ",
                                   series.name, value_label(series.values[g], plot.percent));
    if (has_interval(series, g)) {
        hint += fmt::format(" ({} to {})", value_label(series.low[g], plot.percent),
                            value_label(series.high[g], plot.percent));
    }
    return hint;
}

// Decimals of the numbers on bars, the same for all: enough for three digits of the largest, and no
// more than tell the values exactly.
int number_decimals(const BarPlot& plot) {
    const double unit = plot.percent ? 100.0 : 1.0;
    double most = 0.0;
    for (const BarSeries& series : plot.series) {
        for (const double value : series.values) {
            if (is_plottable(value)) most = std::max(most, std::abs(unit * value));
        }
    }
    const int limit = plot.percent ? 1 : most >= 100.0 ? 0 : most >= 10.0 ? 1 : most >= 1.0 ? 2 : 3;
    const auto is_exact = [&](double value, int decimals) {
        const double shifted = unit * value * std::pow(10.0, decimals);
        return !is_plottable(value) || std::abs(shifted - std::round(shifted)) < 1e-6;
    };
    int decimals = 0;
    for (const BarSeries& series : plot.series) {
        for (const double value : series.values) {
            while (decimals < limit && !is_exact(value, decimals)) ++decimals;
        }
    }
    return decimals;
}

// Without the unit, which the axis shows.
std::string number_of(const BarPlot& plot, double value, int decimals) {
    return tick_label(plot.percent ? 100.0 * value : value, std::pow(10.0, -decimals), false);
}

bool numbers_fit(const BarPlot& plot, const Slots& slots, int decimals) {
    for (const BarSeries& series : plot.series) {
        for (const double value : series.values) {
            if (!is_plottable(value)) continue;
            const double width = label_width(number_of(plot, value, decimals), kNumberSize);
            if (width > slots.bar + 6.0) return false;
        }
    }
    return true;
}

void draw_bar(SvgCanvas& canvas, const BarPlot& plot, const Bar& bar, std::size_t s,
              std::size_t g) {
    canvas.rectangle({bar.left, std::min(bar.zero, bar.end)}, bar.width,
                     std::abs(bar.zero - bar.end), series_paint(s), 1.0, bar_hint(plot, s, g));
    if (!has_interval(plot.series[s], g)) return;
    const double middle = bar.left + 0.5 * bar.width;
    const double half = std::min(4.0, 0.3 * bar.width);
    const std::string path =
        fmt::format("M{0} {3}L{2} {3}M{0} {4}L{2} {4}M{1} {3}L{1} {4}", pixels(middle - half),
                    pixels(middle), pixels(middle + half), pixels(bar.low), pixels(bar.high));
    canvas.outline(path, {&kPaper, 3.0});  // a border, where the whisker crosses its bar
    canvas.outline(path, {&kInk, 1.25});
}

void draw_number(SvgCanvas& canvas, const Bar& bar, double value, const std::string& number) {
    const double y = value < 0.0 ? std::max({bar.low, bar.high, bar.end}) + kNumberGap
                                 : std::min({bar.low, bar.high, bar.end}) - kNumberGap;
    canvas.text({bar.left + 0.5 * bar.width, y}, number,
                {.size = kNumberSize, .anchor = TextAnchor::kMiddle, .classes = "halo"});
}

// Calls draw(bar, series, group) for every bar there is.
template <typename Draw>
void for_each_bar(const BarPlot& plot, const ChartLayout& layout, const PlotAxis& axis,
                  const Slots& slots, Draw draw) {
    for (std::size_t g = 0; g < plot.groups.size(); ++g) {
        for (std::size_t s = 0; s < plot.series.size(); ++s) {
            if (!is_plottable(plot.series[s].values[g])) continue;
            draw(make_bar(plot, layout, axis, slots, s, g), s, g);
        }
    }
}

void draw_references(SvgCanvas& canvas, const BarPlot& plot, const ChartLayout& layout,
                     const PlotAxis& axis) {
    for (const ReferenceLine& line : plot.references) {
        if (!(line.value >= axis.low && line.value <= axis.high)) continue;
        const double y = layout.y(axis, line.value);
        const Paint* paint = line.series ? &series_paint(*line.series) : &kQuiet;
        canvas.line({layout.left, y}, {layout.right, y}, {&kPaper, 2.5});
        canvas.line({layout.left, y}, {layout.right, y}, {paint, 1.5, "5 3"});
    }
}

// Bars first, then what must not hide behind them.
void draw_data(SvgCanvas& canvas, const BarPlot& plot, const ChartLayout& layout,
               const PlotAxis& axis, const Slots& slots) {
    for_each_bar(plot, layout, axis, slots, [&](const Bar& bar, std::size_t s, std::size_t g) {
        draw_bar(canvas, plot, bar, s, g);
    });
    if (axis.low <= 0.0 && axis.high >= 0.0) {
        const double zero = layout.y(axis, 0.0);
        canvas.line({layout.left, zero}, {layout.right, zero}, {&kAxisLine});
    }
    draw_references(canvas, plot, layout, axis);
    const int decimals = number_decimals(plot);
    if (!numbers_fit(plot, slots, decimals)) return;
    for_each_bar(plot, layout, axis, slots, [&](const Bar& bar, std::size_t s, std::size_t g) {
        const double value = plot.series[s].values[g];
        draw_number(canvas, bar, value, number_of(plot, value, decimals));
    });
}

// Returns the height the names take below `top`.
double draw_turned_names(SvgCanvas& canvas, const BarPlot& plot, double top, const Slots& slots) {
    const double size = std::clamp(slots.width - 1.0, 6.0, kNameSize);
    double height = 0.0;
    for (std::size_t g = 0; g < plot.groups.size(); ++g) {
        const std::string shown = shortened_label(plot.groups[g], size, kMostTurned);
        TextStyle style{size, &kQuiet, TextAnchor::kEnd};
        style.turn = -90.0;
        if (shown != plot.groups[g]) style.hint = plot.groups[g];
        canvas.text({slots.middle(g), top + 6.0}, shown, style);
        height = std::max(height, label_width(shown, size));
    }
    return height + 10.0;
}

double draw_names(SvgCanvas& canvas, const BarPlot& plot, double top, const Slots& slots) {
    std::vector<std::vector<std::string>> names;
    std::size_t most = 1;
    const double room = slots.width - 6.0;
    for (const std::string& group : plot.groups) {
        names.push_back(wrapped_label(group, kNameSize, room, 2));
        most = std::max(most, names.back().size());
        std::string joined;
        for (const std::string& line : names.back()) joined += line;
        const bool cut = joined.find("\xE2\x80\xA6") != std::string::npos;
        if (cut && plot.groups.size() > 4) return draw_turned_names(canvas, plot, top, slots);
    }
    for (std::size_t g = 0; g < names.size(); ++g) {
        double y = top + 14.0;
        for (const std::string& line : names[g]) {
            canvas.text({slots.middle(g), y}, line,
                        {.size = kNameSize, .anchor = TextAnchor::kMiddle, .hint = plot.groups[g]});
            y += kNameLine;
        }
    }
    return 10.0 + kNameLine * double(most);
}

}  // namespace

std::string draw_svg(const BarPlot& plot) {
    check(plot);
    const PlotRange range = data_range(plot);
    if (range.empty) return draw_no_data(plot.title, plot.size);
    ChartFrame frame{plot.title, "", plot.y_label, plot.size};
    frame.y = make_axis(range, plot.y_range, plot.percent);
    frame.legend = make_legend(plot);
    frame.headroom = kNumberRoom;
    const ChartLayout layout = lay_out(frame);
    const Slots slots = make_slots(plot, layout);
    SvgCanvas canvas;
    draw_frame(canvas, frame, layout);
    draw_data(canvas, plot, layout, frame.y, slots);
    const double numbers = frame.y.low < 0.0 ? kNumberRoom : 0.0;  // below bars that hang
    const double names = draw_names(canvas, plot, layout.bottom + numbers, slots);
    return finish_chart(canvas, frame, layout, numbers + names);
}

}  // namespace ostraka
