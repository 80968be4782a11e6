// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/segment_page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ostraka/report/line_plot.hpp"
#include "ostraka/report/matrix_plot.hpp"

namespace ostraka {
namespace {

// One value of each kind, in the order of the runs.
template <class Value, class Of>
std::vector<Value> distinct(std::span<const SegmentRun> runs, const Of& of) {
    std::vector<Value> values;
    for (const SegmentRun& run : runs) {
        if (std::find(values.begin(), values.end(), of(run)) == values.end()) {
            values.push_back(of(run));
        }
    }
    return values;
}

std::vector<std::string> libraries_of(std::span<const SegmentRun> runs) {
    return distinct<std::string>(runs, [](const SegmentRun& run) { return run.library; });
}

std::vector<std::string> methods_of(const SegmentRun& run) {
    std::vector<std::string> methods;
    if (run.trials.empty()) return methods;
    // "fused" says most, so it comes last, as in the command's table.
    for (const auto& [method, answers] : run.trials.front().answers) {
        if (method != "fused") methods.push_back(method);
    }
    methods.emplace_back("fused");
    return methods;
}

const SegmentRun* find_run(std::span<const SegmentRun> runs, const std::string& library,
                           double noise) {
    for (const SegmentRun& run : runs) {
        if (run.library == library && run.noise_mr == noise) return &run;
    }
    return nullptr;
}

Table rate_table(std::span<const SegmentRun> runs, std::size_t k_index) {
    Table table{.header = {"library", "noise, mr", "segments"}};
    const std::vector<std::string> methods = methods_of(runs.front());
    table.header.insert(table.header.end(), methods.begin(), methods.end());
    for (const SegmentRun& run : runs) {
        TableRow row{
            {run.library, fmt::format("{:g}", run.noise_mr), std::to_string(run.trials.size())}};
        for (const std::string& method : methods) {
            row.cells.push_back(interval_text(recognition_rate(run.trials, method, k_index)));
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

Table gain_table(std::span<const SegmentRun> runs, std::size_t k_index) {
    const std::string baseline = runs.front().library;
    Table table{.header = {"library", "noise, mr"},
                .caption = fmt::format("Gain over {}, on the same segments", baseline)};
    const std::vector<std::string> methods = methods_of(runs.front());
    table.header.insert(table.header.end(), methods.begin(), methods.end());
    for (const SegmentRun& run : runs) {
        const SegmentRun* base = find_run(runs, baseline, run.noise_mr);
        if (run.library == baseline || base == nullptr) continue;
        TableRow row{{run.library, fmt::format("{:g}", run.noise_mr)}};
        for (const std::string& method : methods) {
            row.cells.push_back(
                interval_text(recognition_gain(run.trials, base->trials, method, k_index), true));
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

void add_point(PlotSeries& series, double x, const Interval& interval) {
    series.x.push_back(x);
    series.y.push_back(interval.value);
    series.low.push_back(interval.low);
    series.high.push_back(interval.high);
}

std::string noise_plot(std::span<const SegmentRun> runs, const std::string& method) {
    LinePlot plot{.title = method,
                  .x_label = "noise, mesh resolutions",
                  .y_label = "recognition rate",
                  .y_range = {{0.0, 1.0}}};
    for (const std::string& library : libraries_of(runs)) {
        PlotSeries series{.name = library};
        for (const SegmentRun& run : runs) {
            if (run.library != library) continue;
            add_point(series, run.noise_mr, recognition_rate(run.trials, method, 0));
        }
        plot.series.push_back(std::move(series));
    }
    return draw_svg(plot);
}

std::string visibility_plot(std::span<const SegmentRun> runs, const std::string& method) {
    LinePlot plot{.title = method,
                  .x_label = "visible share of the object",
                  .y_label = "recognition rate",
                  .x_range = {{0.0, 1.0}},
                  .y_range = {{0.0, 1.0}},
                  .percent_x = true};
    constexpr int kBins = 10;
    for (const std::string& library : libraries_of(runs)) {
        const SegmentRun* run = find_run(runs, library, runs.front().noise_mr);
        if (run == nullptr) continue;
        PlotSeries series{.name = library};
        for (int b = 0; b < kBins; ++b) {
            std::vector<SegmentTrial> inside;
            for (const SegmentTrial& trial : run->trials) {
                const int bin =
                    std::min(kBins - 1, static_cast<int>(trial.visible_fraction * kBins));
                if (bin == b) inside.push_back(trial);
            }
            if (inside.size() < 3) continue;
            add_point(series, (b + 0.5) / kBins, recognition_rate(inside, method, 0));
        }
        plot.series.push_back(std::move(series));
    }
    return draw_svg(plot);
}

std::string k_plot(std::span<const SegmentRun> runs, const std::string& method,
                   std::span<const std::size_t> ks) {
    LinePlot plot{.title = method,
                  .x_label = "k, nearest entries that vote",
                  .y_label = "recognition rate",
                  .y_range = {{0.0, 1.0}}};
    for (const std::string& library : libraries_of(runs)) {
        const SegmentRun* run = find_run(runs, library, runs.front().noise_mr);
        if (run == nullptr) continue;
        PlotSeries series{.name = library};
        for (std::size_t i = 0; i < ks.size(); ++i) {
            add_point(series, static_cast<double>(ks[i]), recognition_rate(run->trials, method, i));
        }
        plot.series.push_back(std::move(series));
    }
    return draw_svg(plot);
}

template <class Draw>
void add_plots(PageContent& page, const std::vector<std::string>& methods, const Draw& draw) {
    std::vector<Figure> figures;
    for (const std::string& method : methods) figures.push_back({draw(method), ""});
    page.figures(figures);
}

void add_facts(PageContent& page, std::span<const SegmentRun> runs) {
    const SegmentRun* last = find_run(runs, runs.back().library, runs.front().noise_mr);
    const Interval fused = recognition_rate(last->trials, "fused", 0);
    double visible = 0.0;
    for (const SegmentTrial& trial : last->trials) visible += trial.visible_fraction;
    visible /= static_cast<double>(std::max<std::size_t>(1, last->trials.size()));
    page.facts(std::vector<Fact>{
        {fmt::format("{:.1f} %", 100.0 * fused.value), "recognized, fused",
         fmt::format("{}; 95 % interval {:.1f} to {:.1f} %", last->library, 100.0 * fused.low,
                     100.0 * fused.high)},
        {std::to_string(last->trials.size()), "segments", "cut out of scenes by ground truth"},
        {fmt::format("{:.0f} %", 100.0 * visible), "visible on average", ""}});
}

}  // namespace

std::string interval_text(const Interval& interval, bool sign) {
    const double half = (interval.high - interval.low) / 2.0;
    return sign ? fmt::format("{:+.3f} ±{:.2f}", interval.value, half)
                : fmt::format("{:.3f} ±{:.2f}", interval.value, half);
}

PageContent segment_page(std::span<const SegmentRun> runs, std::span<const std::string> models,
                         std::span<const std::size_t> ks) {
    PageContent page;
    if (runs.empty() || runs.front().trials.empty()) {
        page.paragraph("No segment was as visible as asked for.");
        return page;
    }
    const std::vector<std::string> methods = methods_of(runs.front());
    add_facts(page, runs);
    page.heading(fmt::format("Recognition rate, k = {}", ks.front()));
    page.paragraph(
        "Share of segments whose first-ranked model is right. Behind ± half of the 95 % "
        "interval, by scenes drawn with repetition.");
    page.table(rate_table(runs, 0));
    if (libraries_of(runs).size() > 1) page.table(gain_table(runs, 0));
    if (distinct<double>(runs, [](const SegmentRun& r) { return r.noise_mr; }).size() > 1) {
        page.heading("Noise");
        add_plots(page, methods, [&](const std::string& m) { return noise_plot(runs, m); });
    }
    page.heading("Visible share");
    page.paragraph("At the first noise level; bins of fewer than 3 segments are left out.");
    add_plots(page, methods, [&](const std::string& m) { return visibility_plot(runs, m); });
    if (ks.size() > 1) {
        page.heading("k");
        add_plots(page, methods, [&](const std::string& m) { return k_plot(runs, m, ks); });
    }
    page.heading("Who is taken for whom");
    const SegmentRun* last = find_run(runs, runs.back().library, runs.front().noise_mr);
    std::vector<std::string> columns(models.begin(), models.end());
    columns.emplace_back("none");
    page.figure(draw_svg(MatrixPlot{fmt::format("{}, fused", last->library), "true model", "answer",
                                    std::vector<std::string>(models.begin(), models.end()), columns,
                                    confusion_matrix(last->trials, "fused", 0, models.size())}));
    return page;
}

}  // namespace ostraka
