// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/scene_page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ostraka/recognition/picture.hpp"
#include "ostraka/report/histogram_plot.hpp"
#include "ostraka/report/line_plot.hpp"
#include "ostraka/report/matrix_plot.hpp"

namespace ostraka {
namespace {

std::string percent(double share) {
    return fmt::format("{:.1f} %", 100.0 * share);
}

std::string percent_interval(const Interval& interval) {
    return fmt::format("95 % interval {:.1f} to {:.1f} %", 100.0 * interval.low,
                       100.0 * interval.high);
}

void add_facts(PageContent& page, std::span<const SceneRecord> records, const ModelLibrary& library,
               const MatchSettings& match) {
    const SceneSummary summary = summarize(records, library, match);
    page.facts(std::vector<Fact>{
        {percent(summary.recall.value), "recall",
         fmt::format("{} of {} objects; {}", summary.hits, summary.objects,
                     percent_interval(summary.recall))},
        {percent(summary.precision.value), "precision",
         fmt::format("{} wrong reports; {}", summary.wrong, percent_interval(summary.precision))},
        {fmt::format("{:.2f} %", 100.0 * summary.median_adi.value), "median ADI of the diameter",
         fmt::format("of the hits; median rotation error {:.2f} degrees", summary.median_degrees)},
        {fmt::format("{:.2f} s", summary.seconds), "a scene",
         fmt::format("mean of {} scenes", records.size())}});
    page.paragraph(fmt::format(
        "An object counts as found if the right model is reported with a confidence of at least "
        "{:g} and an ADI below {:g} % of its diameter. Objects less than {:g} % visible are "
        "ignored.",
        match.min_confidence, 100.0 * match.max_adi, 100.0 * match.min_visible));
}

std::string recall_plot(const std::vector<RecallBin>& bins, std::string label) {
    LinePlot plot{.x_label = std::move(label),
                  .y_label = "recall",
                  .x_range = {{0.0, 1.0}},
                  .y_range = {{0.0, 1.0}},
                  .percent_x = true,
                  .percent_y = true};
    PlotSeries series;
    for (const RecallBin& bin : bins) {
        if (bin.objects == 0) continue;
        series.x.push_back((bin.low + bin.high) / 2.0);
        series.y.push_back(bin.recall.value);
        series.low.push_back(bin.recall.low);
        series.high.push_back(bin.recall.high);
    }
    plot.series.push_back(std::move(series));
    return draw_svg(plot);
}

std::string reliability_plot(const std::vector<ReliabilityBin>& bins) {
    LinePlot plot{.x_label = "confidence",
                  .y_label = "share that is right",
                  .x_range = {{0.0, 1.0}},
                  .y_range = {{0.0, 1.0}},
                  .diagonal = true};
    PlotSeries series{.name = "reports"};
    for (const ReliabilityBin& bin : bins) {
        series.x.push_back(bin.confidence);
        series.y.push_back(bin.right.value);
        series.low.push_back(bin.right.low);
        series.high.push_back(bin.right.high);
    }
    plot.series.push_back(std::move(series));
    return draw_svg(plot);
}

// Recall and precision as the least confidence rises.
std::string threshold_plot(std::span<const SceneRecord> records, const ModelLibrary& library,
                           MatchSettings match) {
    LinePlot plot{.x_label = "least confidence",
                  .x_range = {{0.0, 1.0}},
                  .y_range = {{0.0, 1.0}},
                  .percent_y = true};
    PlotSeries recall{.name = "recall"};
    PlotSeries precision{.name = "precision"};
    for (int i = 0; i < 20; ++i) {
        match.min_confidence = 0.05 * i;
        const SceneSummary summary = summarize(records, library, match);
        for (PlotSeries* series : {&recall, &precision}) {
            series->x.push_back(match.min_confidence);
        }
        recall.y.push_back(summary.recall.value);
        precision.y.push_back(summary.precision.value);
    }
    plot.series = {recall, precision};
    return draw_svg(plot);
}

Table model_table(std::span<const SceneRecord> records, const ModelLibrary& library,
                  const MatchSettings& match_settings) {
    const std::size_t models = library.models.size();
    std::vector<std::size_t> hits(models, 0);
    std::vector<std::size_t> misses(models, 0);
    std::vector<std::size_t> wrong(models, 0);
    std::vector<std::vector<double>> adis(models);
    for (const SceneRecord& record : records) {
        const Matching matching = match(record, library, match_settings);
        for (const PosePair& hit : matching.hits) {
            const std::uint32_t model = record.truth[hit.truth].model;
            ++hits[model];
            adis[model].push_back(hit.adi);
        }
        for (const std::uint32_t miss : matching.misses) ++misses[record.truth[miss].model];
        for (const std::uint32_t w : matching.wrong) ++wrong[record.reports[w].model_index];
    }
    Table table{.header = {"model", "objects", "found", "recall", "wrong reports", "median ADI"}};
    for (std::size_t m = 0; m < models; ++m) {
        const std::size_t objects = hits[m] + misses[m];
        std::sort(adis[m].begin(), adis[m].end());
        table.rows.push_back(
            {{library.models[m].name, std::to_string(objects), std::to_string(hits[m]),
              objects > 0 ? percent(static_cast<double>(hits[m]) / static_cast<double>(objects))
                          : "-",
              std::to_string(wrong[m]),
              adis[m].empty() ? "-"
                              : fmt::format("{:.2f} %", 100.0 * adis[m][adis[m].size() / 2])}});
    }
    return table;
}

Table recall_table(const AverageRecalls& recalls) {
    Table table{.header = {"error", "average recall"},
                .caption = "BOP's average recalls (localization task)"};
    table.rows.push_back({{"MSSD", fmt::format("{:.3f}", recalls.mssd)}});
    if (recalls.has_images) table.rows.push_back({{"MSPD", fmt::format("{:.3f}", recalls.mspd)}});
    if (recalls.has_vsd) {
        table.rows.push_back({{"VSD", fmt::format("{:.3f}", recalls.vsd)}});
        table.rows.push_back(
            {{"mean of the three", fmt::format("{:.3f}", recalls.all())}, RowStatus::kNone, true});
    }
    return table;
}

Table seconds_table(std::span<const SceneRecord> records) {
    std::map<std::string, double> sums;
    for (const SceneRecord& record : records) {
        for (const auto& [stage, seconds] : record.seconds) sums[stage] += seconds;
    }
    Table table{.header = {"stage", "seconds a scene"}};
    for (const auto& [stage, sum] : sums) {
        table.rows.push_back(
            {{stage, fmt::format("{:.3f}", sum / static_cast<double>(records.size()))},
             RowStatus::kNone,
             stage == "all"});
    }
    return table;
}

Image draw(const TestScene& scene, const ModelLibrary& library,
           std::vector<RecognizedObject> objects, int width, bool words) {
    Recognition shown;
    shown.objects = std::move(objects);
    return draw_recognition(scene.cloud, library, shown,
                            {.width = width, .labels = words, .header = false});
}

std::vector<RecognizedObject> truth_as_objects(const SceneRecord& record,
                                               const ModelLibrary& library) {
    std::vector<RecognizedObject> objects;
    for (const TrueObject& object : record.truth) {
        objects.push_back({.model = library.models[object.model].name,
                           .model_index = object.model,
                           .T_scene_model = object.T_scene_model,
                           .confidence = object.visible_fraction,
                           .visible_fraction = object.visible_fraction});
    }
    return objects;
}

std::string failure_text(const SceneRecord& record, const Matching& matching,
                         const ModelLibrary& library) {
    std::string text = record.name + ":";
    for (std::size_t i = 0; i < matching.misses.size(); ++i) {
        const TrueObject& missed = record.truth[matching.misses[i]];
        text += fmt::format(" {} missed ({:.0f} % visible);", library.models[missed.model].name,
                            100.0 * missed.visible_fraction);
    }
    for (const std::uint32_t w : matching.wrong) {
        text += fmt::format(" {} reported wrongly ({:.2f});", record.reports[w].model,
                            record.reports[w].confidence);
    }
    text.pop_back();
    return text;
}

void add_failures(PageContent& page, std::span<const SceneRecord> records, const TestSet& set,
                  const ModelLibrary& library, const ScenePageSettings& settings) {
    struct Failure {
        std::size_t scene = 0;
        double weight = 0.0;
    };
    std::vector<Failure> failures;
    for (std::size_t s = 0; s < records.size(); ++s) {
        const Matching matching = match(records[s], library, settings.match);
        // A wrong report, or an object missed though nearly all of it is seen, is worst.
        double weight = 2.0 * static_cast<double>(matching.wrong.size());
        for (const std::uint32_t miss : matching.misses) {
            weight += 0.5 + records[s].truth[miss].visible_fraction;
        }
        if (weight > 0.0) failures.push_back({s, weight});
    }
    page.heading("Worst failures");
    if (failures.empty()) page.paragraph("There is none.");
    std::stable_sort(failures.begin(), failures.end(),
                     [](const Failure& a, const Failure& b) { return a.weight > b.weight; });
    if (failures.size() > settings.failures) failures.resize(settings.failures);
    for (const Failure& failure : failures) {
        const SceneRecord& record = records[failure.scene];
        const TestScene scene = set.load(failure.scene);
        std::vector<RecognizedObject> reports;
        for (const RecognizedObject& report : record.reports) {
            if (report.confidence >= settings.match.min_confidence) reports.push_back(report);
        }
        page.paragraph(failure_text(record, match(record, library, settings.match), library));
        const int width = settings.picture_width;
        page.pictures(std::vector<Picture>{
            {draw(scene, library, {}, width, false), "scan", "the scan of " + record.name},
            {draw(scene, library, truth_as_objects(record, library), width, true),
             "truth; numbers are visible shares", "the true objects of " + record.name},
            {draw(scene, library, reports, width, true), "answer; numbers are confidences",
             "the reported objects of " + record.name}});
    }
}

}  // namespace

PageContent scene_page(std::span<const SceneRecord> records, const TestSet& set,
                       const ModelLibrary& library, const ScenePageSettings& settings) {
    PageContent page;
    const MatchSettings& match_settings = settings.match;
    add_facts(page, records, library, match_settings);
    page.heading("Recall");
    page.figures(std::vector<Figure>{
        {recall_plot(recall_by_occlusion(records, library, match_settings), "hidden share"),
         "Recall against occlusion, with 95 % intervals."},
        {recall_plot(recall_by_clutter(records, library, match_settings), "clutter"),
         "Recall against clutter: the share of the scan's points that are not the object's."}});
    page.table(model_table(records, library, match_settings));
    page.heading("Confidence");
    page.figures(std::vector<Figure>{
        {reliability_plot(reliability(records, library, match_settings)),
         "Of the reports with a confidence, how many are right. On the dashed line confidence is "
         "what it says."},
        {threshold_plot(records, library, match_settings), "What --min-confidence trades."}});
    page.heading("Pose");
    std::vector<double> adis;
    for (const SceneRecord& record : records) {
        for (const PosePair& hit : match(record, library, match_settings).hits) {
            adis.push_back(hit.adi);
        }
    }
    page.figure(draw_svg(HistogramPlot{.x_label = "ADI of hits, share of the diameter",
                                       .y_label = "hits",
                                       .values = adis,
                                       .percent_x = true}));
    page.table(recall_table(average_recalls(records)));
    page.heading("Who is taken for whom");
    std::vector<std::string> names;
    for (const Model& model : library.models) names.push_back(model.name);
    std::vector<std::string> columns = names;
    columns.emplace_back("none");
    page.figure(draw_svg(MatrixPlot{"", "true model", "reported in its place", names, columns,
                                    confusion_matrix(records, library, match_settings)}));
    add_failures(page, records, set, library, settings);
    page.heading("Time");
    page.table(seconds_table(records));
    return page;
}

}  // namespace ostraka
