// SPDX-License-Identifier: Apache-2.0
// Protocols O and P.
#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "evaluate_output.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/evaluation/run.hpp"
#include "ostraka/evaluation/scene_page.hpp"
#include "ostraka/io/bop_results.hpp"
#include "ostraka/library/library_file.hpp"
#include "scene_options.hpp"

namespace ostraka::app {
namespace {

struct RunOptions {
    EvaluationOutput output;
    SceneOptions scenes;
    std::string library;
    std::string scenes_of;    // library whose models the scenes show; empty: the same
    std::string results;      // BOP CSV to judge instead of recognizing
    std::string bop_results;  // BOP CSV to write
    MatchSettings match;
    SceneSettings settings;
};

// What the pipeline reports below this is never looked at: few true objects lie there.
constexpr double kLeastConfidence = 0.05;

Json vector_json(const std::vector<double>& values) {
    return Json(values);
}

Json outcome_json(const SceneRecord& record, const ModelLibrary& library,
                  const MatchSettings& settings) {
    const Matching matching = match(record, library, settings);
    const auto object = [&](std::uint32_t truth) {
        const TrueObject& o = record.truth[truth];
        return Json{{"model", library.models[o.model].name},
                    {"visible_fraction", o.visible_fraction},
                    {"clutter", record.clutter[truth]}};
    };
    Json hits = Json::array();
    Json misses = Json::array();
    Json wrong = Json::array();
    for (const PosePair& hit : matching.hits) {
        Json one = object(hit.truth);
        one.update({{"confidence", record.reports[hit.report].confidence}, {"adi", hit.adi}});
        hits.push_back(std::move(one));
    }
    for (const std::uint32_t miss : matching.misses) misses.push_back(object(miss));
    for (const std::uint32_t w : matching.wrong) {
        wrong.push_back(
            {{"model", record.reports[w].model}, {"confidence", record.reports[w].confidence}});
    }
    Json pairs = Json::array();
    for (const PosePair& pair : record.pairs) {
        Json one = {{"report", pair.report},
                    {"truth", pair.truth},
                    {"model", record.reports[pair.report].model},
                    {"confidence", record.reports[pair.report].confidence},
                    {"adi", pair.adi},
                    {"mssd", pair.mssd},
                    {"degrees", pair.degrees}};
        if (pair.mspd >= 0.0) one["mspd"] = pair.mspd;
        if (!pair.vsd.empty()) one["vsd"] = vector_json(pair.vsd);
        pairs.push_back(std::move(one));
    }
    return {{"scene", record.name}, {"hits", hits},   {"misses", misses},
            {"wrong", wrong},       {"pairs", pairs}, {"seconds", record.seconds}};
}

Json bins_json(const std::vector<RecallBin>& bins) {
    Json array = Json::array();
    for (const RecallBin& bin : bins) {
        array.push_back({{"from", bin.low},
                         {"to", bin.high},
                         {"objects", bin.objects},
                         {"recall", interval_json(bin.recall)}});
    }
    return array;
}

Json recalls_json(const AverageRecalls& recalls) {
    Json json = {{"mssd", recalls.mssd}};
    if (recalls.has_images) json["mspd"] = recalls.mspd;
    if (recalls.has_vsd) json.update({{"vsd", recalls.vsd}, {"mean", recalls.all()}});
    return json;
}

Json all_json(const RunOptions& options, const std::vector<SceneRecord>& records,
              const ModelLibrary& library, const std::string& protocol) {
    const SceneSummary summary = summarize(records, library, options.match);
    Json reliability_bins = Json::array();
    for (const ReliabilityBin& bin : reliability(records, library, options.match)) {
        reliability_bins.push_back({{"confidence", bin.confidence},
                                    {"reports", bin.reports},
                                    {"right", interval_json(bin.right)}});
    }
    Json details = Json::array();
    std::map<std::string, double> stages;
    for (const SceneRecord& record : records) {
        details.push_back(outcome_json(record, library, options.match));
        for (const auto& [stage, seconds] : record.seconds) {
            stages[stage] += seconds / static_cast<double>(records.size());
        }
    }
    std::vector<std::string> names;
    for (const Model& model : library.models) names.push_back(model.name);
    return {
        {"protocol", protocol},
        {"on", scene_text(options.scenes)},
        {"scenes", records.size()},
        {"objects", summary.objects},
        {"hits", summary.hits},
        {"recall", summary.recall.value},
        {"recall_interval", interval_json(summary.recall)},
        {"wrong", summary.wrong},
        {"precision", summary.precision.value},
        {"precision_interval", interval_json(summary.precision)},
        {"median_adi", summary.median_adi.value},
        {"median_degrees", summary.median_degrees},
        {"average_recall", recalls_json(average_recalls(records))},
        {"recall_by_occlusion", bins_json(recall_by_occlusion(records, library, options.match))},
        {"recall_by_clutter", bins_json(recall_by_clutter(records, library, options.match))},
        {"reliability", reliability_bins},
        {"models", names},
        {"confusion", confusion_matrix(records, library, options.match)},
        {"seconds_per_scene", summary.seconds},
        {"seconds", stages},
        {"details", details}};
}

std::vector<std::vector<std::string>> object_rows(const std::vector<SceneRecord>& records,
                                                  const ModelLibrary& library,
                                                  const MatchSettings& settings) {
    std::vector<std::vector<std::string>> rows = {{"scene", "outcome", "model", "visible",
                                                   "clutter", "confidence", "adi", "mssd", "mspd",
                                                   "degrees"}};
    for (const SceneRecord& record : records) {
        const Matching matching = match(record, library, settings);
        for (const PosePair& hit : matching.hits) {
            const TrueObject& object = record.truth[hit.truth];
            rows.push_back({record.name, "hit", library.models[object.model].name,
                            fmt::format("{:.4f}", object.visible_fraction),
                            fmt::format("{:.4f}", record.clutter[hit.truth]),
                            fmt::format("{:.4f}", record.reports[hit.report].confidence),
                            fmt::format("{:.6f}", hit.adi), fmt::format("{:.6f}", hit.mssd),
                            hit.mspd < 0.0 ? "" : fmt::format("{:.3f}", hit.mspd),
                            fmt::format("{:.3f}", hit.degrees)});
        }
        for (const std::uint32_t miss : matching.misses) {
            const TrueObject& object = record.truth[miss];
            rows.push_back({record.name, "miss", library.models[object.model].name,
                            fmt::format("{:.4f}", object.visible_fraction),
                            fmt::format("{:.4f}", record.clutter[miss]), "", "", "", "", ""});
        }
        for (const std::uint32_t w : matching.wrong) {
            rows.push_back({record.name, "wrong", record.reports[w].model, "", "",
                            fmt::format("{:.4f}", record.reports[w].confidence), "", "", "", ""});
        }
    }
    return rows;
}

// BOP's numbers of the library's models: those of the data set, else 1, 2, ... in their order.
std::vector<int> bop_numbers(const RunOptions& options, const ModelLibrary& library) {
    std::vector<int> numbers;
    for (std::size_t m = 0; m < library.models.size(); ++m) {
        numbers.push_back(static_cast<int>(m) + 1);
    }
    if (options.scenes.data.empty()) return numbers;
    const DataSet data = open_data_set(options.scenes.data);
    for (const RecordedModel& model : data.models) {
        for (std::size_t m = 0; m < library.models.size(); ++m) {
            const std::string& name = library.models[m].name;
            const bool same = name == model.name || name == model.file.stem().string();
            if (same && model.number > 0) numbers[m] = model.number;
        }
    }
    return numbers;
}

void write_results(const RunOptions& options, const std::vector<SceneRecord>& records,
                   const ModelLibrary& library) {
    if (options.bop_results.empty()) return;
    const std::vector<int> numbers = bop_numbers(options, library);
    const double factor = unit_factor(library.settings.unit, Unit::millimeter);
    std::vector<BopResult> results;
    for (const SceneRecord& record : records) {
        const auto all = record.seconds.find("all");
        for (const RecognizedObject& report : record.reports) {
            BopResult result{record.scene,
                             record.image,
                             numbers[report.model_index],
                             report.confidence,
                             report.T_scene_model,
                             all == record.seconds.end() ? -1.0 : all->second};
            result.T_camera_model.translation() *= factor;
            results.push_back(result);
        }
    }
    write_bop_results(options.bop_results, results);
    say("BOP results: " + options.bop_results);
}

std::vector<SceneRecord> judge_results(const RunOptions& options, const ModelLibrary& library,
                                       const TestSet& set) {
    const std::vector<int> numbers = bop_numbers(options, library);
    const double factor = unit_factor(Unit::millimeter, library.settings.unit);
    std::map<std::pair<int, int>, std::vector<RecognizedObject>> reports;
    for (const BopResult& result : read_bop_results(options.results)) {
        for (std::uint32_t m = 0; m < numbers.size(); ++m) {
            if (numbers[m] != result.object) continue;
            RecognizedObject report{.model = library.models[m].name,
                                    .model_index = m,
                                    .T_scene_model = result.T_camera_model,
                                    .confidence = result.score};
            report.T_scene_model.translation() *= factor;
            reports[{result.scene, result.image}].push_back(report);
        }
    }
    const PoseJudge judge(library, options.settings.vsd);
    const Progress progress = progress_bar();
    std::vector<SceneRecord> records;
    for (std::size_t i = 0; i < set.count; ++i) {
        const TestScene scene = set.load(i);
        records.push_back(
            record_of(judge, scene, reports[{scene.scene, scene.image}], options.settings));
        report(progress, "scenes", i + 1, set.count);
    }
    return records;
}

void say_summary(const RunOptions& options, const std::vector<SceneRecord>& records,
                 const ModelLibrary& library) {
    const SceneSummary summary = summarize(records, library, options.match);
    const auto range = [](const Interval& interval) {
        return fmt::format("{:.3f} to {:.3f}", interval.low, interval.high);
    };
    say_table(
        {{"scenes", "objects", "recall", "95 %", "wrong", "precision", "95 %", "median ADI",
          "degrees", "s / scene"},
         {std::to_string(records.size()), std::to_string(summary.objects),
          fmt::format("{:.3f}", summary.recall.value), range(summary.recall),
          std::to_string(summary.wrong), fmt::format("{:.3f}", summary.precision.value),
          range(summary.precision), fmt::format("{:.4f}", summary.median_adi.value),
          fmt::format("{:.2f}", summary.median_degrees), fmt::format("{:.3f}", summary.seconds)}});
    const AverageRecalls recalls = average_recalls(records);
    std::string text = fmt::format("average recall: MSSD {:.3f}", recalls.mssd);
    if (recalls.has_images) text += fmt::format(", MSPD {:.3f}", recalls.mspd);
    if (recalls.has_vsd)
        text += fmt::format(", VSD {:.3f}, mean {:.3f}", recalls.vsd, recalls.all());
    say(text);
}

TestSet set_of(const RunOptions& options, const ModelLibrary& library) {
    if (options.scenes_of.empty()) return test_set_of(options.scenes, library);
    // A set may need its library as long as it lives.
    const auto kept = std::make_shared<const ModelLibrary>(load_library(options.scenes_of));
    if (kept->settings.unit != library.settings.unit) {
        throw InvalidInput(options.scenes_of + ": its unit is not the library's");
    }
    TestSet set = for_library(test_set_of(options.scenes, *kept), *kept, library);
    set.load = [kept, load = std::move(set.load)](std::size_t i) { return load(i); };
    return set;
}

void run_evaluate_scenes(RunOptions& options, bool pose) {
    catch_interrupts();
    options.settings.vsd = pose;
    options.settings.recognition.min_confidence =
        std::min(kLeastConfidence, options.match.min_confidence);
    const ModelLibrary library = load_library(options.library);
    const TestSet set = set_of(options, library);
    const std::string protocol = pose ? "pose" : "scenes";
    std::vector<SceneRecord> records;
    if (!options.results.empty()) {
        records = judge_results(options, library, set);
    } else {
        const std::string digest =
            options.output.journal.empty() ? "" : files_digest({options.library});
        Journal journal(options.output.journal,
                        fmt::format("{} {} {}", protocol, digest, set.description));
        if (journal.size() > 0) say(fmt::format("{} scenes are done already", journal.size()));
        const Recognizer recognizer(library);
        records = run_scenes(recognizer, library, set, options.settings, journal, progress_bar());
    }
    say_summary(options, records, library);
    write_results(options, records, library);
    write_csv(object_rows(records, library, options.match), options.output.csv);
    write_json(all_json(options, records, library, protocol), options.output.common.json);
    if (options.output.html.empty()) return;
    write_page(options.output, "Objects in scenes: what is found, and how well?",
               scene_text(options.scenes),
               scene_page(records, set, library, {.match = options.match}));
}

void add_run(CLI::App& parent, const std::string& name, const std::string& help, bool pose) {
    auto options = std::make_shared<RunOptions>();
    options->scenes.kind = pose ? "drop" : "tabletop";
    options->scenes.choice = "turns";
    CLI::App* command = parent.add_subcommand(name, help);
    command->add_option("library", options->library, "library made by `ostraka build`")->required();
    add_scene_kind(*command, options->scenes);
    add_scene_options(*command, options->scenes, "the library's unit");
    add_scene_noise(*command, options->scenes, "the library's unit");
    command->add_flag_callback(
        "--viewpoint-unknown", [options] { options->settings.recognition.viewpoint_known = false; },
        "recognize as if nobody knew where the sensor was: free space can't contradict");
    command
        ->add_option("--time-limit", options->settings.recognition.time_limit,
                     "seconds for a scene, after which the best so far is taken; 0: none")
        ->check(CLI::NonNegativeNumber);
    command->add_option("--scenes-of", options->scenes_of,
                        "make the scenes from this library's models instead: those that LIBRARY "
                        "lacks are unknown to it, and whatever it reports there is wrong");
    command
        ->add_option("--max-adi", options->match.max_adi,
                     "pose error of a right detection, in model diameters")
        ->capture_default_str();
    command
        ->add_option("--min-visible", options->match.min_visible,
                     "true objects less visible are ignored")
        ->capture_default_str();
    command
        ->add_option("--min-confidence", options->match.min_confidence,
                     "reports below it don't count")
        ->capture_default_str();
    command->add_option(
        "--bop-results", options->bop_results,
        "write what is reported as BOP's CSV: scene_id,im_id,obj_id,score,R,t,time");
    if (pose) {
        command->add_option("--results", options->results,
                            "judge these results (BOP's CSV) instead of recognizing");
        command
            ->add_option("--vsd-delta", options->settings.vsd_delta,
                         "tolerance of the visibility for VSD, mm")
            ->capture_default_str();
    }
    add_output(*command, options->output);
    command->callback([options, pose] { run_evaluate_scenes(*options, pose); });
}

}  // namespace

void add_evaluate_scenes(CLI::App& parent) {
    add_run(parent, "scenes", "protocol O: recognize whole scans, told nothing about what is there",
            false);
    add_run(parent, "pose",
            "protocol P: BOP's pose errors (MSSD, MSPD, VSD) of what is recognized, or of results "
            "in BOP's CSV",
            true);
}

}  // namespace ostraka::app
