// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/advice_page.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "ostraka/evaluation/segment_page.hpp"
#include "ostraka/report/bar_plot.hpp"
#include "ostraka/report/line_plot.hpp"
#include "ostraka/report/matrix_plot.hpp"

namespace ostraka {
namespace {

constexpr const char* kQuarterNames[] = {"0 to 25 % hidden", "25 to 50 %", "50 to 75 %",
                                         "more than 75 %"};

std::string length(double value, Unit unit) {
    return fmt::format("{:.3g} {}", value, unit_name(unit));
}

std::string distance_text(double value, Unit unit) {
    return fmt::format("{:.4g} {}", value, unit_name(unit));
}

std::string percent(double share) {
    return fmt::format("{:.0f} %", 100.0 * share);
}

std::string percent_range(const Interval& interval) {
    return fmt::format("{:.0f} to {:.0f} %", 100.0 * interval.low, 100.0 * interval.high);
}

// "8 of 9, 89 % (70 to 100 %)", or a dash.
std::string found_text(const RecallBin& bin) {
    if (bin.objects == 0) return "-";
    const double objects = static_cast<double>(bin.objects);
    return fmt::format("{:.0f} of {}, {}", bin.recall.value * objects, bin.objects,
                       percent(bin.recall.value));
}

void add_bar(BarSeries& series, const RecallBin& bin) {
    const bool known = bin.objects > 0;
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    series.values.push_back(known ? bin.recall.value : nothing);
    series.low.push_back(known ? bin.recall.low : nothing);
    series.high.push_back(known ? bin.recall.high : nothing);
}

BarPlot recall_bars(const Advice& advice) {
    BarPlot plot{
        .y_label = "found", .y_range = {{0.0, 1.0}}, .percent = true, .size = {kWholePlot, 220}};
    for (const PartAdvice& part : advice.parts) plot.groups.push_back(part.name);
    return plot;
}

std::string distance_plot(const Advice& advice, Unit unit) {
    BarPlot plot = recall_bars(advice);
    for (std::size_t d = 0; d < advice.distances.size(); ++d) {
        BarSeries series{.name = distance_text(advice.distances[d].reach.distance, unit)};
        for (const PartAdvice& part : advice.parts) add_bar(series, part.by_distance[d]);
        plot.series.push_back(std::move(series));
    }
    return draw_svg(plot);
}

std::string hidden_plot(const Advice& advice) {
    BarPlot plot = recall_bars(advice);
    for (std::size_t q = 0; q < std::size(kQuarterNames); ++q) {
        BarSeries series{.name = kQuarterNames[q]};
        for (const PartAdvice& part : advice.parts) add_bar(series, part.by_hidden[q]);
        plot.series.push_back(std::move(series));
    }
    return draw_svg(plot);
}

RowStatus status_of(Outlook outlook) {
    return outlook == Outlook::good  ? RowStatus::kGood
           : outlook == Outlook::bad ? RowStatus::kBad
                                     : RowStatus::kNone;
}

void add_facts(PageContent& page, const Advice& advice, Unit unit) {
    const DistanceAdvice& middle = advice.distances[advice.distances.size() / 2];
    std::size_t good = 0;
    for (const PartAdvice& part : advice.parts) good += part.outlook == Outlook::good ? 1U : 0U;
    page.facts(std::vector<Fact>{
        {fmt::format("{} of {}", good, advice.parts.size()), "parts with a good outlook",
         "the verdicts below say to what occlusion and distance"},
        {percent(middle.summary.recall.value),
         "of objects found at " + distance_text(middle.reach.distance, unit),
         fmt::format("{} of {} in heaps; 95 % interval {}", middle.summary.hits,
                     middle.summary.objects, percent_range(middle.summary.recall))},
        {percent(middle.summary.precision.value), "of reports right there",
         fmt::format("wrong reports: {}", middle.summary.wrong)},
        {length(advice.library.sampling, unit), "sampling distance that suits",
         fmt::format("entries a part: {}; descriptors: {}", advice.library.selection.budget,
                     advice.library.descriptors.size())}});
}

void add_verdicts(PageContent& page, const Advice& advice, Unit unit) {
    Table table{.header = {"part", "verdict", "objects"}, .text_columns = 2};
    for (const PartAdvice& part : advice.parts) {
        std::size_t objects = 0;
        for (const RecallBin& bin : part.by_distance) objects += bin.objects;
        table.rows.push_back(
            {{part.name, part.verdict, std::to_string(objects)}, status_of(part.outlook)});
    }
    page.table(table);
    for (const std::string& warning : advice.warnings) page.paragraph("Warning: " + warning);
    page.figure(distance_plot(advice, unit),
                "Share of each part's objects found, by distance, however much of them is hidden "
                "(up to 90 %). Whiskers: 95 % intervals.");
    page.figure(hidden_plot(advice),
                "The same by hidden share, all distances together. No bar: no such object was in "
                "the scenes; a bar without whiskers rests on few.");
}

void add_distances(PageContent& page, const Advice& advice, Unit unit) {
    page.heading("What the sensor sees");
    std::vector<Picture> pictures;
    Table table{.header = {"distance", "found", "95 % interval", "objects", "wrong reports",
                           "pixels apart", "depth deviates by", "median pose error"}};
    for (const DistanceAdvice& at : advice.distances) {
        const std::string distance = distance_text(at.reach.distance, unit);
        if (!at.example.pixels.empty()) {
            pictures.push_back({at.example, distance + ": " + at.example_text,
                                "a simulated scan at " + distance + " with what was found"});
        }
        table.rows.push_back(
            {{distance, percent(at.summary.recall.value), percent_range(at.summary.recall),
              std::to_string(at.summary.objects), std::to_string(at.summary.wrong),
              length(at.reach.pitch, unit), length(at.reach.deviation, unit),
              fmt::format("{:.2f} %", 100.0 * at.summary.median_adi.value)}});
    }
    if (!pictures.empty()) {
        page.paragraph(
            "A typical heap at each distance, as this sensor measures it (gray), with what was "
            "found in it (colored; the number is the confidence).");
        page.pictures(pictures);
    }
    page.table(table);
    page.note(
        "Pose error: ADI in diameters, of the objects found. Depth deviation: of one pixel "
        "on a surface that faces the sensor, noise and rounding together.");
}

std::string look_alike_text(const LookAlike& alike, const Advice& advice) {
    const std::string& name = advice.parts[alike.part].name;
    const std::string& other = advice.parts[alike.other].name;
    const std::string sides = fmt::format("from {} of {} sides", alike.confused, alike.viewpoints);
    if (alike.confused > 0) {
        return fmt::format(
            "{} looks like another part {}; most like {} here: its entry is {:.1f} "
            "times nearer",
            name, sides, other, 1.0 / std::max(alike.margin, 1e-3));
    }
    return fmt::format(
        "{}: never nearest to another part; closest to {} here, {:.1f} times "
        "farther than its own entry",
        name, other, alike.margin);
}

void add_confusions(PageContent& page, const Advice& advice) {
    page.heading("Who is taken for whom");
    std::vector<std::string> names;
    for (const PartAdvice& part : advice.parts) names.push_back(part.name);
    std::vector<std::string> columns = names;
    columns.emplace_back("none");
    page.figure(draw_svg(MatrixPlot{"", "true part", "reported in its place", names, columns,
                                    advice.confusion}),
                "Objects of all heaps. Off the diagonal: another part was reported where this one "
                "lies. None: it was missed.");
    std::vector<Picture> pictures;
    for (const LookAlike& alike : advice.look_alikes) {
        if (alike.other == kNoIndex || alike.picture.pixels.empty()) continue;
        pictures.push_back(
            {alike.picture, look_alike_text(alike, advice),
             advice.parts[alike.part].name + " beside " + advice.parts[alike.other].name});
    }
    if (pictures.empty()) return;
    page.heading("Look-alikes", 3);
    page.paragraph(
        "Each part alone, seen by this sensor from all sides, and compared with the library by its "
        "global shape. Shown is the side from which it is hardest to tell from another part, and "
        "that part beside it, turned as it is matched. Keypoints, which the whole pipeline also "
        "uses, tell most of these apart.");
    page.pictures(pictures);
}

std::string descriptor_list(const SettingsTrial& trial) {
    std::string text;
    for (const std::string& name : trial.descriptors) text += (text.empty() ? "" : ", ") + name;
    return text;
}

Table trial_table(const Advice& advice, Unit unit) {
    Table table{.header = {"sampling", "budget", "entries", "file", "built in", "recognized"},
                .caption = "Sampling distance and entries a part, all descriptors"};
    for (std::size_t i = 0; i < advice.trials.size(); ++i) {
        const SettingsTrial& trial = advice.trials[i];
        table.rows.push_back(
            {{length(trial.sampling, unit), std::to_string(trial.budget),
              std::to_string(trial.entries),
              fmt::format("{:.1f} MB", static_cast<double>(trial.bytes) / 1e6),
              fmt::format("{:.1f} s", trial.build_seconds), interval_text(trial.fused())},
             i == advice.chosen ? RowStatus::kGood : RowStatus::kNone,
             i == advice.chosen});
    }
    return table;
}

Table descriptor_table(const Advice& advice) {
    Table table{.header = {"descriptors", "file", "with keypoints", "alone"},
                .caption = "Descriptors, at the sampling distance and budget chosen"};
    for (std::size_t i = 0; i < advice.descriptor_trials.size(); ++i) {
        const SettingsTrial& trial = advice.descriptor_trials[i];
        const bool one = trial.descriptors.size() == 1;
        table.rows.push_back(
            {{descriptor_list(trial),
              fmt::format("{:.1f} MB", static_cast<double>(trial.bytes) / 1e6),
              interval_text(trial.fused()),
              one ? interval_text(trial.rates.at(trial.descriptors.front())) : "-"},
             i == advice.chosen_descriptors ? RowStatus::kGood : RowStatus::kNone,
             i == advice.chosen_descriptors});
    }
    return table;
}

std::string trial_plot(const Advice& advice, Unit unit) {
    LinePlot plot{.x_label = "budget, entries a part",
                  .y_label = "segments recognized",
                  .y_range = {{0.0, 1.0}},
                  .percent_y = true,
                  .size = {kHalfPlot, 200}};
    for (const SettingsTrial& trial : advice.trials) {
        const std::string name = "sampling " + length(trial.sampling, unit);
        if (plot.series.empty() || plot.series.back().name != name) {
            plot.series.push_back({.name = name});
        }
        PlotSeries& series = plot.series.back();
        series.x.push_back(trial.budget);
        series.y.push_back(trial.fused().value);
        series.low.push_back(trial.fused().low);
        series.high.push_back(trial.fused().high);
    }
    return draw_svg(plot);
}

std::string method_plot(const Advice& advice) {
    BarPlot plot{.y_label = "segments recognized",
                 .y_range = {{0.0, 1.0}},
                 .percent = true,
                 .size = {kHalfPlot, 200}};
    BarSeries series;
    for (const auto& [method, rate] : advice.trials[advice.chosen].rates) {
        plot.groups.push_back(method);
        series.values.push_back(rate.value);
        series.low.push_back(rate.low);
        series.high.push_back(rate.high);
    }
    plot.series.push_back(std::move(series));
    return draw_svg(plot);
}

void add_confirmation(PageContent& page, const Advice& advice) {
    const Confirmation& made = advice.confirmation;
    if (!made.made) return;
    page.paragraph(fmt::format(
        "Segments are few and not the whole job, so the smallest good library was tried against "
        "the usual one (the first sampling distance, 48 entries a part, all descriptors) in the "
        "same heaps: it found {} ({}), the usual one {} ({}). {}",
        percent(made.small.value), percent_range(made.small), percent(made.usual.value),
        percent_range(made.usual),
        made.kept ? "It loses less than 3 points, so it is recommended."
                  : "It loses 3 points or more, so the usual one is recommended."));
}

void add_settings(PageContent& page, const Advice& advice, Unit unit, const std::string& command) {
    page.heading("Settings that suit");
    page.paragraph("Build the library with:");
    std::string lines = command;
    if (const std::size_t at = lines.find(" --unit"); at != std::string::npos) {
        lines.insert(at, " \\\n   ");
    }
    page.preformatted(lines);
    const SamplingAdvice& rule = advice.sampling;
    page.paragraph(fmt::format(
        "Sampling distance by rule: 1 % of the median diameter is {}. It should not be below {}, "
        "the distance of the pixels at the middle distance, nor below {}, twice the deviation that "
        "smoothing leaves; nor above {}, 2 % of the smallest diameter. That gives {}{}.",
        length(rule.usual, unit), length(rule.pitch, unit), length(rule.noise, unit),
        length(rule.most, unit), length(rule.sampling, unit),
        rule.conflict() ? ", though the limits conflict" : ""));
    if (advice.trials.size() < 2) return;
    page.paragraph(fmt::format(
        "Libraries made in several ways were tried on {} segments of simulated scans, 15 to 90 % "
        "hidden: chosen is the smallest whose rate is within the 95 % interval of the best.",
        advice.segments));
    page.table(trial_table(advice, unit));
    page.figures(std::vector<Figure>{
        {trial_plot(advice, unit), "Rate of the whole ranking against the budget."},
        {method_plot(advice),
         "What each way of comparing achieves alone, in the chosen library; "
         "fused is what recognition uses."}});
    if (!advice.descriptor_trials.empty()) page.table(descriptor_table(advice));
    add_confirmation(page, advice);
}

void add_details(PageContent& page, const Advice& advice, Unit unit) {
    PageContent inner;
    Table table{.header = {"part", "diameter", "distance", "pixels across", kQuarterNames[0],
                           kQuarterNames[1], kQuarterNames[2], kQuarterNames[3], "all",
                           "95 % interval"}};
    for (const PartAdvice& part : advice.parts) {
        for (std::size_t d = 0; d < part.by_distance.size(); ++d) {
            TableRow row{{part.name, length(part.diameter, unit),
                          distance_text(part.by_distance[d].low, unit),
                          fmt::format("{:.0f}", part.pixels[d])}};
            for (const RecallBin& bin : part.by_both[d]) row.cells.push_back(found_text(bin));
            row.cells.push_back(found_text(part.by_distance[d]));
            row.cells.push_back(percent_range(part.by_distance[d].recall));
            table.rows.push_back(std::move(row));
        }
    }
    inner.table(table);
    page.details("All counts: part by distance by hidden share", inner);
}

}  // namespace

PageContent advice_page(const Advice& advice, const AdviceSettings& settings,
                        const std::string& command) {
    const Unit unit = settings.library.unit;
    PageContent page;
    add_facts(page, advice, unit);
    page.heading("Verdicts");
    add_verdicts(page, advice, unit);
    add_distances(page, advice, unit);
    add_confusions(page, advice);
    add_settings(page, advice, unit, command);
    page.heading("How this was worked out");
    page.paragraph(fmt::format(
        "At each distance {} heaps of {} objects were dropped on a table and scanned by a "
        "simulated "
        "{} sensor from above. The whole pipeline ran on each scan, told nothing about what is "
        "there. An object is found if the right part is reported with a confidence of at least "
        "{:g} and a mean pose error (ADI) below {:g} % of its diameter. Objects more than {:.0f} % "
        "hidden don't count.",
        settings.scenes, settings.objects, settings.sensor.name, settings.match.min_confidence,
        100.0 * settings.match.max_adi, 100.0 * (1.0 - settings.match.min_visible)));
    page.note(
        "Intervals: 95 %, by scenes drawn with repetition. Where all of n objects were found, the "
        "interval has no width, but the true rate may still be as low as 1 - 3 / n. The sensor's "
        "noise, edges, shadows and holes are modeled; reflections of shiny or clear parts, "
        "vibration and calibration errors are not.");
    add_details(page, advice, unit);
    return page;
}

}  // namespace ostraka
