// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "calibrate.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "evaluate_output.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/library/edit.hpp"
#include "ostraka/library/library_file.hpp"

namespace ostraka::app {
namespace {

struct CalibrateOptions {
    CommonOptions common;
    std::string library;
    CalibrationSettings settings;
    std::string examples;
};

// One line for each: its features and whether it was right.
void write_examples(const std::vector<Example>& examples, const std::string& path) {
    std::vector<std::vector<std::string>> rows(1);
    for (std::size_t i = 0; i < kFeatures; ++i) {
        rows[0].emplace_back(feature_name(static_cast<Feature>(i)));
    }
    rows[0].emplace_back("right");
    for (const Example& example : examples) {
        std::vector<std::string>& row = rows.emplace_back();
        for (const double value : example.features) row.push_back(fmt::format("{:.6g}", value));
        row.emplace_back(example.right ? "1" : "0");
    }
    write_csv(rows, path);
}

Json result_json(const CalibrationResult& result) {
    Json weights = Json::object();
    for (std::size_t i = 0; i < kFeatures; ++i) {
        weights[std::string(feature_name(static_cast<Feature>(i)))] = result.confidence.weights[i];
    }
    return {{"examples", result.examples.size()}, {"right", result.right()}, {"weights", weights}};
}

void run_calibrate(const CalibrateOptions& options) {
    catch_interrupts();
    const CalibrationResult result = calibrate_library(options.library, options.settings);
    write_examples(result.examples, options.examples);
    Json json = result_json(result);
    json["library"] = options.library;
    json["scenes"] = options.settings.scenes;
    write_json(json, options.common.json);
}

}  // namespace

std::size_t CalibrationResult::right() const {
    return static_cast<std::size_t>(std::count_if(examples.begin(), examples.end(),
                                                  [](const Example& one) { return one.right; }));
}

CalibrationResult calibrate_library(const std::string& library,
                                    const CalibrationSettings& settings) {
    ModelLibrary models = load_library(library);
    models.confidence.reset();  // learned anew from the general weights
    models.merged_confidence.reset();
    const bool merged = settings.kind == ScanKind::merged;
    CalibrationResult result;
    result.examples = calibration_examples(models, settings, progress_bar());
    result.confidence = fit_confidence(
        result.examples, merged ? merged_confidence() : general_confidence(), settings.prior);
    set_confidence(library, result.confidence, settings.kind);
    say(fmt::format("{}: confidence{} learned from {} reports, {} of them right, in {} scenes",
                    library, merged ? " in merged scans" : "", result.examples.size(),
                    result.right(), settings.scenes));
    return result;
}

void add_calibrate(CLI::App& parent) {
    auto options = std::make_shared<CalibrateOptions>();
    CLI::App* command = parent.add_subcommand(
        "calibrate",
        "learn from simulated scenes what a report of this library's models is worth, so that of "
        "the objects reported with confidence 0.9 nine in ten are right; to be repeated after "
        "models have changed");
    command->add_option("library", options->library, "library made by `ostraka build`")->required();
    command->add_option("--scenes", options->settings.scenes, "simulated scenes to learn from")
        ->capture_default_str()
        ->check(CLI::Range(1, 100000));
    command->add_option("--seed", options->settings.seed, "seed of the scenes")
        ->capture_default_str();
    command->add_option("--examples", options->examples,
                        "write what it learned from as CSV: the features of each report, and "
                        "whether it was right");
    command->add_flag_callback(
        "--viewpoint-unknown", [options] { options->settings.kind = ScanKind::merged; },
        "learn how merged scans are to be judged, and scans of which nobody knows the viewpoint: "
        "other things count there");
    add_common(*command, options->common);
    command->callback([options] { run_calibrate(*options); });
}

}  // namespace ostraka::app
