// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "calibrate.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "ostraka/library/edit.hpp"
#include "ostraka/library/library_file.hpp"

namespace ostraka::app {
namespace {

struct CalibrateOptions {
    CommonOptions common;
    std::string library;
    CalibrationSettings settings;
};

void run_calibrate(const CalibrateOptions& options) {
    catch_interrupts();
    const CalibrationResult result = calibrate_library(options.library, options.settings);
    Json weights = Json::object();
    for (std::size_t i = 0; i < kFeatures; ++i) {
        weights[std::string(feature_name(static_cast<Feature>(i)))] = result.confidence.weights[i];
    }
    write_json({{"library", options.library},
                {"scenes", options.settings.scenes},
                {"examples", result.examples},
                {"right", result.right},
                {"weights", weights}},
               options.common.json);
}

}  // namespace

CalibrationResult calibrate_library(const std::string& library,
                                    const CalibrationSettings& settings) {
    ModelLibrary models = load_library(library);
    models.confidence.reset();  // learned anew from the general weights
    const std::vector<Example> examples = calibration_examples(models, settings, progress_bar());
    CalibrationResult result{fit_confidence(examples, general_confidence(), settings.prior)};
    result.examples = examples.size();
    for (const Example& example : examples) result.right += example.right ? 1U : 0U;
    set_confidence(library, result.confidence);
    say(fmt::format("{}: confidence learned from {} reports, {} of them right, in {} scenes",
                    library, result.examples, result.right, settings.scenes));
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
    add_common(*command, options->common);
    command->callback([options] { run_calibrate(*options); });
}

}  // namespace ostraka::app
