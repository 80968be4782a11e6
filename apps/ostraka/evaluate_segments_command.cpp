// SPDX-License-Identifier: Apache-2.0
// Protocol S.
#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "evaluate_output.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/evaluation/run.hpp"
#include "ostraka/evaluation/segment_page.hpp"
#include "ostraka/library/library_file.hpp"
#include "scene_options.hpp"

namespace ostraka::app {
namespace {

struct SegmentOptions {
    EvaluationOutput output;
    SceneOptions scenes;
    std::vector<std::string> libraries;
    std::string noise = "0";
    std::string ks = "1";
    std::string metric;
    SegmentSettings settings;
};

std::vector<SegmentRun> run_all(const SegmentOptions& options,
                                const std::vector<ModelLibrary>& libraries) {
    std::vector<std::unique_ptr<EntryIndex>> indices;
    std::vector<const EntryIndex*> pointers;
    for (const ModelLibrary& library : libraries) {
        indices.push_back(std::make_unique<EntryIndex>(library, parse_metric(options.metric)));
        pointers.push_back(indices.back().get());
    }
    // One noise for all libraries, or they would not see the same scenes.
    const double resolution = mesh_resolution(libraries.front().models.front().surface.points);
    const std::string digest =
        options.output.journal.empty() ? "" : files_digest(options.libraries);
    std::vector<SegmentRun> runs;
    for (const double noise : parse_numbers(options.noise, "--noise")) {
        SceneOptions scenes = options.scenes;
        scenes.noise = noise * resolution;
        const TestSet set = test_set_of(scenes, libraries.front());
        Journal journal(options.output.journal,
                        fmt::format("segments {} {} k {} metric {} visible {} {}", digest,
                                    set.description, options.ks, options.metric,
                                    options.settings.min_visible, options.settings.max_visible));
        if (journal.size() > 0) say(fmt::format("{} scenes are done already", journal.size()));
        auto trials = run_segments(pointers, set, options.settings, journal, progress_bar());
        for (std::size_t i = 0; i < libraries.size(); ++i) {
            const std::string name = std::filesystem::path(options.libraries[i]).stem().string();
            runs.push_back({name, noise, std::move(trials[i])});
        }
    }
    return runs;
}

double mean_visible(const SegmentRun& run) {
    double sum = 0.0;
    for (const SegmentTrial& trial : run.trials) sum += trial.visible_fraction;
    return sum / static_cast<double>(std::max<std::size_t>(1, run.trials.size()));
}

// The first library's run at the same noise; null for that one itself.
const SegmentRun* baseline_of(const std::vector<SegmentRun>& runs, const SegmentRun& run) {
    for (const SegmentRun& other : runs) {
        if (other.noise_mr != run.noise_mr) continue;
        return &other == &run || other.library == run.library ? nullptr : &other;
    }
    return nullptr;
}

std::vector<std::string> methods_of_all(const std::vector<ModelLibrary>& libraries) {
    std::vector<std::string> methods;
    for (const std::string& method : methods_of(libraries.front())) {
        bool everywhere = true;
        for (const ModelLibrary& library : libraries) {
            const auto own = methods_of(library);
            everywhere = everywhere && std::find(own.begin(), own.end(), method) != own.end();
        }
        if (everywhere) methods.push_back(method);
    }
    return methods;
}

void report_runs(const SegmentOptions& options, const std::vector<SegmentRun>& runs,
                 const std::vector<std::string>& methods) {
    std::vector<std::vector<std::string>> table = {
        {"library", "noise mr", "segments", "mean visible", "k"}};
    table.front().insert(table.front().end(), methods.begin(), methods.end());
    std::vector<std::vector<std::string>> csv = {{"library", "noise_mr", "k", "method", "segments",
                                                  "rate", "low", "high", "gain", "gain_low",
                                                  "gain_high"}};
    Json results = Json::array();
    for (const SegmentRun& run : runs) {
        const SegmentRun* base = baseline_of(runs, run);
        for (std::size_t k = 0; k < options.settings.ks.size(); ++k) {
            const std::string k_text = std::to_string(options.settings.ks[k]);
            std::vector<std::string> row = {run.library, fmt::format("{:g}", run.noise_mr),
                                            std::to_string(run.trials.size()),
                                            fmt::format("{:.2f}", mean_visible(run)), k_text};
            Json rates = Json::object();
            Json intervals = Json::object();
            Json gains = Json::object();
            for (const std::string& method : methods) {
                const Interval rate = recognition_rate(run.trials, method, k);
                row.push_back(fmt::format("{:.3f}", rate.value));
                rates[method] = rate.value;
                intervals[method] = interval_json(rate);
                std::vector<std::string> line = {run.library,
                                                 fmt::format("{:g}", run.noise_mr),
                                                 k_text,
                                                 method,
                                                 std::to_string(run.trials.size()),
                                                 fmt::format("{:.6f}", rate.value),
                                                 fmt::format("{:.6f}", rate.low),
                                                 fmt::format("{:.6f}", rate.high),
                                                 "",
                                                 "",
                                                 ""};
                if (base != nullptr) {
                    const Interval gain = recognition_gain(run.trials, base->trials, method, k);
                    gains[method] = interval_json(gain);
                    line[8] = fmt::format("{:.6f}", gain.value);
                    line[9] = fmt::format("{:.6f}", gain.low);
                    line[10] = fmt::format("{:.6f}", gain.high);
                }
                csv.push_back(std::move(line));
            }
            table.push_back(std::move(row));
            results.push_back({{"library", run.library},
                               {"noise_mr", run.noise_mr},
                               {"k", options.settings.ks[k]},
                               {"segments", run.trials.size()},
                               {"mean_visible", mean_visible(run)},
                               {"recognition_rate", rates},
                               {"interval", intervals},
                               {"gain", gains}});
        }
    }
    say_table(table);
    write_csv(csv, options.output.csv);
    write_json(
        {{"protocol", "segments"}, {"scenes", scene_text(options.scenes)}, {"results", results}},
        options.output.common.json);
}

void run_evaluate_segments(SegmentOptions& options) {
    catch_interrupts();
    options.settings.ks.clear();
    for (const double k : parse_numbers(options.ks, "--k")) {
        if (!(k >= 1.0 && k <= 1e5)) throw CLI::ValidationError("--k", "numbers from 1 to 100000");
        options.settings.ks.push_back(static_cast<std::size_t>(k));
    }
    std::vector<ModelLibrary> libraries;
    for (const std::string& path : options.libraries) libraries.push_back(load_library(path));
    const std::vector<SegmentRun> runs = run_all(options, libraries);
    report_runs(options, runs, methods_of_all(libraries));
    if (options.output.html.empty()) return;
    std::vector<std::string> models;
    for (const Model& model : libraries.front().models) models.push_back(model.name);
    write_page(options.output, "Pieces of objects: which model do they belong to?",
               scene_text(options.scenes), segment_page(runs, models, options.settings.ks));
}

}  // namespace

void add_evaluate_segments(CLI::App& parent) {
    auto options = std::make_shared<SegmentOptions>();
    CLI::App* command = parent.add_subcommand(
        "segments", "protocol S: classify segments cut out of scenes by ground truth");
    command
        ->add_option("libraries", options->libraries,
                     "libraries to compare, on the same scenes; gains are over the first")
        ->required();
    add_scene_kind(*command, options->scenes);
    add_scene_options(*command, options->scenes, "the library's unit");
    command
        ->add_option("--noise", options->noise,
                     "deviations of the depth noise, in mesh resolutions (mr), comma-separated")
        ->capture_default_str();
    command->add_option("--min-visible", options->settings.min_visible, "least visible fraction")
        ->capture_default_str();
    command->add_option("--max-visible", options->settings.max_visible, "greatest visible fraction")
        ->capture_default_str();
    command
        ->add_option("--metric", options->metric,
                     "distance of all descriptors: l1, l2, chi_square, hellinger (default: the "
                     "one that suits each)")
        ->check(CLI::IsMember({"l1", "l2", "chi_square", "hellinger"}));
    command->add_option("--k", options->ks, "nearest entries that vote, comma-separated")
        ->capture_default_str();
    add_output(*command, options->output);
    command->callback([options] { run_evaluate_segments(*options); });
}

}  // namespace ostraka::app
