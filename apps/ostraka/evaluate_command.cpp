// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/base/random.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/evaluation/scenes.hpp"
#include "ostraka/evaluation/segments.hpp"
#include "ostraka/library/library_file.hpp"

namespace ostraka::app {
namespace {

SceneModels models_of(const ModelLibrary& library) {
    std::vector<TriangleMesh> meshes;
    std::vector<MeshShape> shapes;
    for (const Model& model : library.models) {
        meshes.push_back(model.mesh);
        shapes.push_back(model.shape);
    }
    return scene_models(std::move(meshes), std::move(shapes));
}

struct SegmentOptions {
    CommonOptions common;
    std::vector<std::string> libraries;
    std::string noise = "0";
    std::string metric;
    std::size_t k = 1;
    SegmentSettings settings;
};

// One line a descriptor, one column a library and noise level.
void run_segments(SegmentOptions& options) {
    catch_interrupts();
    Json results = Json::array();
    std::vector<std::vector<std::string>> rows = {{"library", "noise mr", "segments",
                                                   "mean visible", "vfh", "esf", "gasd", "shot",
                                                   "rops", "bow", "keypoints", "fused"}};
    for (const std::string& path : options.libraries) {
        const ModelLibrary library = load_library(path);
        const EntryIndex index(library, parse_metric(options.metric));
        const SceneModels models = models_of(library);
        const double resolution = mesh_resolution(library.models.front().surface.points);
        for (const double noise : parse_numbers(options.noise, "--noise")) {
            SegmentSettings settings = options.settings;
            settings.views.sensor.ranging = {.noise = noise * resolution, .seed = settings.views.seed};
            const auto segments = simulate_segments(models, settings, progress_bar());
            double visible = 0.0;
            for (const LabeledSegment& segment : segments) visible += segment.visible_fraction;
            visible /= static_cast<double>(std::max<std::size_t>(1, segments.size()));
            const auto rates = recognition_rates(index, segments, options.k);
            std::vector<std::string> row = {path, fmt::format("{:g}", noise),
                                            std::to_string(segments.size()),
                                            fmt::format("{:.2f}", visible)};
            for (std::size_t c = 4; c < rows.front().size(); ++c) {
                const std::string& name = rows.front()[c];
                const auto it = rates.find(name == "bow" ? "bag_of_words" : name);
                row.push_back(it == rates.end() ? "-" : fmt::format("{:.3f}", it->second));
            }
            rows.push_back(row);
            results.push_back({{"library", path},
                               {"noise_mr", noise},
                               {"k", options.k},
                               {"segments", segments.size()},
                               {"mean_visible", visible},
                               {"recognition_rate", rates}});
        }
    }
    say_table(rows);
    write_json({{"protocol", "segments"}, {"results", results}}, options.common.json);
}

struct SceneOptions {
    CommonOptions common;
    std::string library;
    int scenes = 60;
    double noise = 0.0;
    double min_confidence = 0.5;
    MatchSettings match;
    TabletopSettings tabletop;
};

void run_scenes(SceneOptions& options) {
    catch_interrupts();
    const ModelLibrary library = load_library(options.library);
    const Recognizer recognizer(library);
    const SceneModels models = models_of(library);
    TabletopSettings settings = options.tabletop;
    settings.sensor.ranging = {.noise = options.noise, .seed = settings.seed};
    RecognitionSettings recognition_settings;
    recognition_settings.min_confidence = options.min_confidence;
    const Progress progress = progress_bar();
    std::vector<SceneOutcome> outcomes;
    Json details = Json::array();
    double seconds = 0.0;
    for (int i = 0; i < options.scenes; ++i) {
        // Every model has its turn, so that few scenes still cover all.
        std::vector<std::uint32_t> chosen;
        for (int o = 0; o < settings.objects; ++o) {
            chosen.push_back(static_cast<std::uint32_t>((i * settings.objects + o)) %
                             static_cast<std::uint32_t>(models.meshes.size()));
        }
        const SimulatedScene scene =
            simulate_tabletop(models, chosen, static_cast<std::uint64_t>(i), settings);
        const Stopwatch watch;
        const Recognition recognition = recognizer.recognize(scene.cloud, recognition_settings);
        seconds += watch.seconds();
        outcomes.push_back(match_outcome(recognition, scene.objects, library, options.match));
        const SceneOutcome& outcome = outcomes.back();
        const auto list = [&](const std::vector<Outcome>& some) {
            Json array = Json::array();
            for (const Outcome& one : some) {
                array.push_back({{"model", library.models[one.model].name},
                                 {"visible_fraction", one.visible_fraction},
                                 {"confidence", one.confidence},
                                 {"adi", one.adi}});
            }
            return array;
        };
        details.push_back({{"scene", i},
                           {"hits", list(outcome.hits)},
                           {"misses", list(outcome.misses)},
                           {"wrong", list(outcome.wrong)}});
        report(progress, "scenes", static_cast<std::size_t>(i) + 1,
               static_cast<std::size_t>(options.scenes));
    }
    const SceneSummary summary = summarize(outcomes);
    say_table({{"scenes", "objects", "recall", "wrong", "precision", "median ADI", "s / scene"},
               {std::to_string(options.scenes), std::to_string(summary.objects),
                fmt::format("{:.3f}", summary.recall), std::to_string(summary.wrong),
                fmt::format("{:.3f}", summary.precision), fmt::format("{:.4f}", summary.median_adi),
                fmt::format("{:.3f}", seconds / options.scenes)}});
    write_json({{"protocol", "scenes"},
                {"scenes", options.scenes},
                {"objects", summary.objects},
                {"hits", summary.hits},
                {"recall", summary.recall},
                {"wrong", summary.wrong},
                {"precision", summary.precision},
                {"median_adi", summary.median_adi},
                {"seconds_per_scene", seconds / options.scenes},
                {"details", details}},
               options.common.json);
}

void add_segments(CLI::App& parent) {
    auto options = std::make_shared<SegmentOptions>();
    CLI::App* command = parent.add_subcommand(
        "segments",
        "protocol S: classify segments cut from simulated scenes of the library's models");
    command->add_option("libraries", options->libraries, "libraries to compare, on the same scenes")
        ->required();
    command->add_option("--scenes", options->settings.scenes, "random-view scenes")
        ->capture_default_str();
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
    command->add_option("--k", options->k, "nearest entries that vote")
        ->capture_default_str()
        ->check(CLI::Range(1, 100000));
    command->add_option("--seed", options->settings.views.seed, "seed of the scenes")
        ->capture_default_str();
    add_common(*command, options->common);
    command->callback([options] { run_segments(*options); });
}

void add_scenes(CLI::App& parent) {
    auto options = std::make_shared<SceneOptions>();
    options->tabletop.spacing = 0.9;
    CLI::App* command = parent.add_subcommand(
        "scenes", "protocol O: recognize simulated tabletop scenes of the library's models");
    command->add_option("library", options->library, "library made by `ostraka build`")->required();
    command->add_option("--scenes", options->scenes, "scenes to simulate")->capture_default_str();
    command->add_option("--objects", options->tabletop.objects, "objects in each scene")
        ->capture_default_str();
    command
        ->add_option("--spacing", options->tabletop.spacing, "between neighbors, in mean diameters")
        ->capture_default_str();
    command
        ->add_option("--noise", options->noise,
                     "standard deviation of the depth, in the library's unit")
        ->capture_default_str();
    command
        ->add_option("--max-adi", options->match.max_adi,
                     "pose error of a right detection, in model diameters")
        ->capture_default_str();
    command
        ->add_option("--min-confidence", options->min_confidence,
                     "objects below it are not reported")
        ->capture_default_str();
    command->add_option("--seed", options->tabletop.seed, "seed of the scenes")
        ->capture_default_str();
    add_common(*command, options->common);
    command->callback([options] { run_scenes(*options); });
}

}  // namespace

void add_evaluate(CLI::App& app) {
    CLI::App* command = app.add_subcommand("evaluate", "measure how well a library recognizes");
    command->require_subcommand(1);
    add_segments(*command);
    add_scenes(*command);
    add_evaluate_library(*command);
}

}  // namespace ostraka::app
