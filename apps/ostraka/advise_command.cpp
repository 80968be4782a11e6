// SPDX-License-Identifier: Apache-2.0
// How well parts will be recognized, told before the cell is built.
#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "evaluate_output.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/evaluation/advice_page.hpp"

namespace ostraka::app {
namespace {

struct AdviseOptions {
    CommonOptions common;
    std::vector<std::string> models;
    std::string unit;
    std::string sensor;
    std::string distances;
    std::string html;
    bool quick = false;
    int scenes = 0;  // 0: by quick
    AdviceSettings settings;
};

std::string sensor_list() {
    std::string text = "Sensors:\n";
    for (const SensorPreset& preset : sensor_presets(Unit::millimeter)) {
        text += fmt::format("  {:<22} {}\n", preset.name, preset.description);
    }
    return text;
}

// What the library is made with that the rules didn't choose.
void make_quick(AdviceSettings& settings) {
    settings.compare = false;
    settings.scenes = 3;
    settings.segment_scenes = 4;
    settings.viewpoints = 12;
    settings.library.views.count = 20;
    settings.library.selection.budget = 24;
}

std::string command_of(const AdviseOptions& options, const LibrarySettings& settings) {
    const LibrarySettings usual;
    std::string command = "ostraka build";
    for (const std::string& model : options.models) command += " " + model;
    command += fmt::format(" --unit {} --sampling {:.4g} --budget {}", unit_name(settings.unit),
                           settings.sampling, settings.selection.budget);
    if (settings.views.count != usual.views.count) {
        command += fmt::format(" --views {}", settings.views.count);
    }
    if (settings.descriptors.size() != usual.descriptors.size()) {
        std::string names;
        for (const AnyDescriptor& descriptor : settings.descriptors) {
            names += (names.empty() ? "" : ",") + std::string(descriptor_name(descriptor));
        }
        command += " --descriptors " + names;
    }
    return command + " -o parts.ostraka";
}

Json bins_json(std::span<const RecallBin> bins, const char* low, const char* high) {
    Json array = Json::array();
    for (const RecallBin& bin : bins) {
        Json one = {{low, bin.low}};
        if (high != nullptr) one[high] = bin.high;
        one.update({{"objects", bin.objects}, {"found", interval_json(bin.recall)}});
        array.push_back(std::move(one));
    }
    return array;
}

Json parts_json(const Advice& advice) {
    constexpr const char* kOutlooks[] = {"good", "mixed", "bad"};
    Json array = Json::array();
    for (const PartAdvice& part : advice.parts) {
        Json both = Json::array();
        for (const auto& bins : part.by_both) {
            both.push_back(bins_json(bins, "hidden_from", "hidden_to"));
        }
        array.push_back({{"part", part.name},
                         {"outlook", kOutlooks[static_cast<int>(part.outlook)]},
                         {"verdict", part.verdict},
                         {"diameter", part.diameter},
                         {"pixels_across", part.pixels},
                         {"wrong_reports", part.wrong},
                         {"by_distance", bins_json(part.by_distance, "distance", nullptr)},
                         {"by_hidden", bins_json(part.by_hidden, "hidden_from", "hidden_to")},
                         {"by_distance_and_hidden", both}});
    }
    return array;
}

Json distances_json(const Advice& advice) {
    Json array = Json::array();
    for (const DistanceAdvice& at : advice.distances) {
        array.push_back({{"distance", at.reach.distance},
                         {"pixel_pitch", at.reach.pitch},
                         {"depth_deviation", at.reach.deviation},
                         {"objects", at.summary.objects},
                         {"found", interval_json(at.summary.recall)},
                         {"wrong", at.summary.wrong},
                         {"precision", interval_json(at.summary.precision)},
                         {"median_adi", at.summary.median_adi.value},
                         {"seconds_per_scene", at.summary.seconds}});
    }
    return array;
}

Json trials_json(std::span<const SettingsTrial> trials, std::size_t chosen) {
    Json array = Json::array();
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const SettingsTrial& trial = trials[i];
        Json rates = Json::object();
        for (const auto& [method, rate] : trial.rates) rates[method] = interval_json(rate);
        Json one = {{"sampling", trial.sampling},
                    {"budget", trial.budget},
                    {"descriptors", trial.descriptors},
                    {"entries", trial.entries},
                    {"bytes", trial.bytes},
                    {"recognition_rate", rates},
                    {"chosen", i == chosen}};
        if (trial.build_seconds >= 0.0) one["build_seconds"] = trial.build_seconds;
        array.push_back(std::move(one));
    }
    return array;
}

Json look_alikes_json(const Advice& advice) {
    Json array = Json::array();
    for (const LookAlike& alike : advice.look_alikes) {
        Json one = {{"part", advice.parts[alike.part].name},
                    {"confused_viewpoints", alike.confused},
                    {"viewpoints", alike.viewpoints}};
        if (alike.other != kNoIndex) {
            one.update({{"most_like", advice.parts[alike.other].name},
                        {"viewpoint", alike.viewpoint},
                        {"margin", alike.margin}});
        }
        array.push_back(std::move(one));
    }
    return array;
}

Json confirmation_json(const Confirmation& made) {
    if (!made.made) return nullptr;
    return {{"small", interval_json(made.small)},
            {"usual", interval_json(made.usual)},
            {"loss", interval_json(made.loss)},
            {"kept", made.kept}};
}

Json advice_json(const AdviseOptions& options, const Advice& advice, const std::string& command) {
    Json names = Json::array();
    for (const PartAdvice& part : advice.parts) names.push_back(part.name);
    const SamplingAdvice& rule = advice.sampling;
    return {{"sensor", options.settings.sensor.name},
            {"unit", unit_name(options.settings.library.unit)},
            {"quick", options.quick},
            {"scenes", options.settings.scenes},
            {"distances", distances_json(advice)},
            {"parts", parts_json(advice)},
            {"models", names},
            {"confusion", advice.confusion},
            {"look_alikes", look_alikes_json(advice)},
            {"sampling",
             {{"usual", rule.usual},
              {"pixel_pitch", rule.pitch},
              {"noise_limit", rule.noise},
              {"most", rule.most},
              {"by_rule", rule.sampling},
              {"conflict", rule.conflict()}}},
            {"segments", advice.segments},
            {"trials", trials_json(advice.trials, advice.chosen)},
            {"descriptor_trials", trials_json(advice.descriptor_trials, advice.chosen_descriptors)},
            {"confirmation", confirmation_json(advice.confirmation)},
            {"warnings", advice.warnings},
            {"command", command}};
}

void say_advice(const Advice& advice, const AdviceSettings& settings, const std::string& command) {
    std::vector<std::vector<std::string>> rows = {{"part"}};
    for (const DistanceAdvice& at : advice.distances) {
        rows.front().push_back(
            fmt::format("{:.4g} {}", at.reach.distance, unit_name(settings.library.unit)));
    }
    for (const char* hidden : {"to 25 %", "to 50 %", "to 75 %", "hidden more"}) {
        rows.front().emplace_back(hidden);
    }
    const auto add = [](std::vector<std::string>& row, const RecallBin& bin) {
        row.push_back(bin.objects == 0
                          ? "-"
                          : fmt::format("{:.0f} % of {}", 100.0 * bin.recall.value, bin.objects));
    };
    for (const PartAdvice& part : advice.parts) {
        rows.push_back({part.name});
        for (const RecallBin& bin : part.by_distance) add(rows.back(), bin);
        for (const RecallBin& bin : part.by_hidden) add(rows.back(), bin);
    }
    say_table(rows);
    say("");
    for (const PartAdvice& part : advice.parts) say(part.name + ": " + part.verdict);
    for (const std::string& warning : advice.warnings) say("warning: " + warning);
    say("\n" + command);
}

void run_advise(AdviseOptions& options) {
    catch_interrupts();
    AdviceSettings& settings = options.settings;
    settings.library.unit = require_unit(options.unit, "");
    settings.sensor = *find_sensor_preset(options.sensor, settings.library.unit);
    if (!options.distances.empty()) {
        settings.distances = parse_numbers(options.distances, "--distances");
    }
    if (options.quick) make_quick(settings);
    if (options.scenes > 0) settings.scenes = options.scenes;
    settings.pictures = !options.html.empty();
    std::vector<ModelSource> models;
    for (const std::string& path : options.models) models.push_back(load_model(path));
    const Advice advice = advise(models, settings, progress_bar());
    const std::string command = command_of(options, advice.library);
    say_advice(advice, settings, command);
    write_json(advice_json(options, advice, command), options.common.json);
    write_page({.html = options.html}, "Will these parts be recognized?",
               fmt::format("{} parts, {} sensor ({})", models.size(), settings.sensor.name,
                           settings.sensor.description),
               advice_page(advice, settings, command));
}

}  // namespace

void add_advise(CLI::App& app) {
    auto options = std::make_shared<AdviseOptions>();
    CLI::App* command = app.add_subcommand(
        "advise",
        "how well will these parts be recognized, with which sensor, from how far, half hidden? "
        "Told by simulation, before anything is bought or built");
    command->add_option("models", options->models, "mesh files of all parts that may lie there")
        ->required();
    add_unit(*command, options->unit, "unit of the numbers in the model files");
    command->add_option("--sensor", options->sensor, "kind of depth camera, see below")
        ->required()
        ->check([](const std::string& name) {
            return find_sensor_preset(name, Unit::millimeter)
                       ? std::string()
                       : "no sensor is called " + name + "\n" + sensor_list();
        });
    command->add_option("--distances", options->distances,
                        "from the sensor to the parts, comma-separated, in --unit (default: three "
                        "around the sensor's usual distance)");
    command
        ->add_option("--scenes", options->scenes,
                     "heaps simulated at each distance (default: 12, with --quick 3); four times "
                     "as many halve the intervals")
        ->check(CLI::Range(1, 100000));
    command
        ->add_option("--objects", options->settings.objects,
                     "parts dropped in each heap: more hide each other more")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    command->add_flag("--quick", options->quick,
                      "a first impression in about a minute: a small library, few scenes, settings "
                      "by rule only");
    command->add_option("--seed", options->settings.seed, "seed of every random step")
        ->capture_default_str();
    command->add_option("--html", options->html,
                        "write the report: verdicts, plots and pictures, one file");
    add_common(*command, options->common);
    command->footer(sensor_list() +
                    "\nExample:\n"
                    "  ostraka advise parts/*.ply --unit mm --sensor structured-light-fine "
                    "--html advice.html\n"
                    "Two to three minutes for six parts on two cores. A part's rate at a distance "
                    "rests on about\n"
                    "scenes * objects / parts objects; intervals say how far it may be off. "
                    "docs/advise.md\ntells how to read the report and what simulation leaves out.");
    command->callback([options] { run_advise(*options); });
}

}  // namespace ostraka::app
