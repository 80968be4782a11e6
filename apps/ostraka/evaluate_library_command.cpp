// SPDX-License-Identifier: Apache-2.0
// Which entries a library needs: protocol S for libraries of the same models made in different
// ways.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/evaluation/segments.hpp"
#include "ostraka/library/build.hpp"
#include "ostraka/library/library_file.hpp"
#include "ostraka/library/model_record.hpp"

namespace ostraka::app {
namespace {

struct LibraryOptions {
    CommonOptions common;
    std::vector<std::string> models;
    std::string unit;
    std::string budgets = "16,32,48,64,128";
    double noise = 0.0;
    bool without_icp = false;
    LibrarySettings settings;
    SegmentSettings segments;
    int scenes = 60;
    std::uint64_t seed = 0;
};

// One way to make a library.
struct Variant {
    std::string name;
    LibrarySettings settings;
    int thinned = 0;  // entries a model that are taken of the variant before; 0: built
};

std::vector<Variant> variants_of(const LibraryOptions& options) {
    std::vector<Variant> variants;
    const auto add = [&](std::string name, Redundancy redundancy, int budget, bool spread) {
        Variant variant{std::move(name), options.settings};
        variant.settings.selection.redundancy = redundancy;
        variant.settings.selection.budget = budget;
        if (!spread) variant.settings.selection.spread = 0;
        variants.push_back(std::move(variant));
    };
    add("full views", Redundancy::none, 0, false);
    variants.back().settings.full_views_only = true;
    add("all candidates", Redundancy::none, 0, false);
    if (!options.without_icp) add("ICP", Redundancy::icp, 0, false);
    const std::vector<double> budgets = parse_numbers(options.budgets, "--budgets");
    for (const double value : budgets) {
        const int budget = static_cast<int>(value);
        if (!options.without_icp) {
            // Registering all pairs takes minutes; once is enough.
            add(fmt::format("ICP, {}", budget), Redundancy::icp, budget, false);
            variants.back().thinned = budget;
        }
    }
    for (const double value : budgets) {
        const int budget = static_cast<int>(value);
        add(fmt::format("surface, {}, no spread", budget), Redundancy::surface, budget, false);
        add(fmt::format("surface, {}", budget), Redundancy::surface, budget, true);
    }
    return variants;
}

std::uintmax_t file_size_of(const ModelLibrary& library) {
    const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                       fmt::format("ostraka_evaluate_{}.ostraka", ::getpid());
    save_library(library, path);
    const std::uintmax_t size = std::filesystem::file_size(path);
    std::filesystem::remove(path);
    return size;
}

// The segments of random-view scenes, models in the order of their names, as libraries have them.
std::vector<LabeledSegment> make_segments(const std::vector<ModelSource>& models,
                                          const LibraryOptions& options) {
    std::vector<const ModelSource*> by_name;
    for (const ModelSource& model : models) by_name.push_back(&model);
    std::sort(by_name.begin(), by_name.end(),
              [](const auto* a, const auto* b) { return a->name < b->name; });
    std::vector<TriangleMesh> meshes;
    for (const ModelSource* model : by_name) meshes.push_back(model->mesh);
    RandomViewSettings views{.seed = options.seed};
    views.sensor.ranging = {.noise = options.noise * options.settings.sampling,
                            .seed = options.seed};
    const SceneModels scene_set = scene_models(std::move(meshes));
    std::vector<std::vector<LabeledSegment>> of_scene(static_cast<std::size_t>(options.scenes));
    parallel_for(of_scene.size(), [&](std::size_t i) {
        SimulatedScene made = simulate_random_view(scene_set, i, views);
        const TestScene scene{.cloud = std::move(made.cloud),
                              .objects = std::move(made.objects),
                              .labels = std::move(made.labels)};
        of_scene[i] = segments_of(scene, i, options.segments);
    });
    std::vector<LabeledSegment> all;
    for (std::vector<LabeledSegment>& segments : of_scene) {
        std::move(segments.begin(), segments.end(), std::back_inserter(all));
    }
    return all;
}

std::vector<SegmentTrial> try_all(const ModelLibrary& library,
                                  const std::vector<LabeledSegment>& segments) {
    const EntryIndex index(library);
    std::vector<SegmentTrial> trials(segments.size());
    const std::vector<std::size_t> ks = {1};
    parallel_for(segments.size(),
                 [&](std::size_t i) { trials[i] = try_segment(index, segments[i], ks); });
    return trials;
}

void run_library(LibraryOptions& options) {
    catch_interrupts();
    std::vector<ModelSource> models;
    for (const std::string& path : options.models) models.push_back(load_model(path));
    options.settings.unit = require_unit(options.unit, "");
    if (options.settings.sampling == 0.0) {
        std::vector<ModelInput> inputs;
        for (const ModelSource& model : models) inputs.push_back(model_input(model));
        options.settings.sampling = default_sampling(inputs);
    }
    const std::vector<LabeledSegment> segments = make_segments(models, options);
    std::vector<std::string> columns = {"vfh", "esf", "gasd", "shot", "rops", "keypoints", "fused"};
    std::vector<std::vector<std::string>> rows = {{"library", "entries", "MB", "build s"}};
    rows.front().insert(rows.front().end(), columns.begin(), columns.end());
    Json results = Json::array();
    ModelLibrary built;
    double seconds = 0.0;
    for (const Variant& variant : variants_of(options)) {
        say(variant.name);
        const Stopwatch watch;
        if (variant.thinned == 0) {
            built = build_library(models, variant.settings, progress_bar());
            seconds = watch.seconds();
        }
        const ModelLibrary library =
            variant.thinned == 0 ? built : thin_library(built, variant.thinned);
        const std::uintmax_t bytes = file_size_of(library);
        const std::vector<SegmentTrial> trials = try_all(library, segments);
        Json rates = Json::object();
        for (const std::string& method : methods_of(library)) {
            rates[method] = recognition_rate(trials, method, 0).value;
        }
        rows.push_back({variant.name, std::to_string(library.entries.size()),
                        fmt::format("{:.1f}", static_cast<double>(bytes) / 1e6),
                        fmt::format("{:.1f}", seconds)});
        for (const std::string& column : columns) {
            const auto it = rates.find(column);
            rows.back().push_back(it == rates.end() ? "-"
                                                    : fmt::format("{:.3f}", it->get<double>()));
        }
        results.push_back({{"library", variant.name},
                           {"entries", library.entries.size()},
                           {"bytes", bytes},
                           {"build_seconds", seconds},
                           {"recognition_rate", rates}});
    }
    say(fmt::format("{} segments", segments.size()));
    say_table(rows);
    write_json({{"protocol", "library"}, {"segments", segments.size()}, {"results", results}},
               options.common.json);
}

}  // namespace

void add_evaluate_library(CLI::App& parent) {
    auto options = std::make_shared<LibraryOptions>();
    CLI::App* command = parent.add_subcommand(
        "library",
        "protocol S for libraries of the same models made in different ways: whole views, all "
        "candidates, the study's ICP, ours at several budgets");
    command->add_option("models", options->models, "mesh files")->required();
    add_unit(*command, options->unit, "unit of the numbers in the model files");
    command->add_option("--budgets", options->budgets, "entries a model, comma-separated")
        ->capture_default_str();
    command->add_option("--views", options->settings.views.count, "viewpoints around each model")
        ->capture_default_str();
    command->add_option("--directions", options->settings.cuts.directions, "cut directions")
        ->capture_default_str();
    command->add_flag("--without-icp", options->without_icp,
                      "leave out the study's way, which is slow");
    command->add_option("--scenes", options->scenes, "random-view scenes")->capture_default_str();
    command
        ->add_option("--noise", options->noise,
                     "standard deviation of the depth noise, in sampling distances")
        ->capture_default_str();
    command->add_option("--seed", options->seed, "seed of the scenes")->capture_default_str();
    add_common(*command, options->common);
    command->callback([options] { run_library(*options); });
}

}  // namespace ostraka::app
