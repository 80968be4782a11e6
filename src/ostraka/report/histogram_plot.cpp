// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/histogram_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/report/chart_frame.hpp"

namespace ostraka {
namespace {

struct Bins {
    double low = 0.0;  // of the first
    double step = 1.0;
    std::vector<std::size_t> counts;
    std::size_t outside = 0;  // values beyond the axis
};

int bin_count(const HistogramPlot& plot, std::size_t values) {
    if (plot.bins < 0 || plot.bins > 1000) {
        throw InvalidInput(fmt::format("plot: {} bins", plot.bins));
    }
    if (plot.bins > 0) return plot.bins;
    return std::clamp(static_cast<int>(std::lround(2.0 * std::cbrt(double(values)))), 5, 40);
}

// Bins start at multiples of their step, so that their borders meet the axis' ticks.
Bins fill_bins(const HistogramPlot& plot, const PlotAxis& axis, std::size_t values) {
    Bins bins;
    bins.step = nice_step(axis.high - axis.low, bin_count(plot, values));
    bins.low = bins.step * std::floor(axis.low / bins.step + 1e-9);
    const double count = std::ceil((axis.high - bins.low) / bins.step - 1e-9);
    bins.counts.resize(static_cast<std::size_t>(std::max(count, 1.0)), 0);
    for (const double value : plot.values) {
        if (!is_plottable(value)) continue;
        if (value < axis.low || value > axis.high) {
            ++bins.outside;
            continue;
        }
        const double bin = std::floor((value - bins.low) / bins.step + 1e-9);
        const double last = double(bins.counts.size() - 1);
        ++bins.counts[static_cast<std::size_t>(std::clamp(bin, 0.0, last))];
    }
    return bins;
}

void draw_bins(SvgCanvas& canvas, const HistogramPlot& plot, const ChartLayout& layout,
               const PlotAxis& x, const PlotAxis& y, const Bins& bins) {
    for (std::size_t b = 0; b < bins.counts.size(); ++b) {
        if (bins.counts[b] == 0) continue;
        const double low = std::max(bins.low + bins.step * double(b), x.low);
        const double high = std::min(bins.low + bins.step * double(b + 1), x.high);
        const double left = layout.x(x, low);
        const double width = layout.x(x, high) - left;
        const double top = layout.y(y, double(bins.counts[b]));
        const double gap = width > 4.0 ? 1.0 : 0.0;
        canvas.rectangle({left + 0.5 * gap, top}, width - gap, layout.bottom - top, series_paint(0),
                         1.0,
                         fmt::format("{} to {}: {}", tick_label(low, bins.step, plot.percent_x),
                                     tick_label(high, bins.step, plot.percent_x), bins.counts[b]));
    }
}

void draw_references(SvgCanvas& canvas, const HistogramPlot& plot, const ChartLayout& layout,
                     const PlotAxis& x) {
    for (std::size_t i = 0; i < plot.references.size(); ++i) {
        const ReferenceLine& line = plot.references[i];
        if (!(line.value >= x.low && line.value <= x.high)) continue;
        const double at = layout.x(x, line.value);
        const Paint& paint = series_paint(line.series.value_or(i + 1));
        canvas.line({at, layout.top}, {at, layout.bottom}, {&kPaper, 3.5});
        canvas.line({at, layout.top}, {at, layout.bottom}, {&paint, 1.5, "5 3"});
    }
}

std::vector<LegendEntry> make_legend(const HistogramPlot& plot) {
    std::vector<LegendEntry> legend;
    for (std::size_t i = 0; i < plot.references.size(); ++i) {
        const ReferenceLine& line = plot.references[i];
        if (!is_plottable(line.value) || line.name.empty()) continue;
        const std::size_t series = line.series.value_or(i + 1);
        legend.push_back({line.name, LegendEntry::Kind::kReference, &series_paint(series), series});
    }
    return legend;
}

}  // namespace

std::string draw_svg(const HistogramPlot& plot) {
    PlotRange range;
    std::size_t values = 0;
    for (const double value : plot.values) {
        range.include(value);
        values += is_plottable(value) ? 1 : 0;
    }
    if (values == 0) return draw_no_data(plot.title, plot.size);
    const PlotAxis x = make_axis(range, plot.x_range, plot.percent_x, 6);
    const Bins bins = fill_bins(plot, x, values);
    PlotRange counts;
    counts.include(0.0);
    counts.include(
        std::max(1.0, double(*std::max_element(bins.counts.begin(), bins.counts.end()))));
    ChartFrame frame{plot.title, plot.x_label, plot.y_label, plot.size};
    if (bins.outside > 0) {
        frame.x_label += fmt::format("{}({} outside of the range shown)",
                                     plot.x_label.empty() ? "" : " ", bins.outside);
    }
    frame.y = make_axis(counts, {}, false, counts.high < 5.0 ? int(counts.high) : 5);
    frame.legend = make_legend(plot);
    const ChartLayout layout = lay_out(frame);
    SvgCanvas canvas;
    draw_frame(canvas, frame, layout);
    draw_bins(canvas, plot, layout, x, frame.y, bins);
    draw_references(canvas, plot, layout, x);
    const double labels = draw_x_axis(canvas, layout, x);
    return finish_chart(canvas, frame, layout, labels);
}

}  // namespace ostraka
