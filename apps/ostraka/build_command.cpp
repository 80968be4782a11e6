// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>

#include "calibrate.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/library/build.hpp"
#include "ostraka/library/build_file.hpp"
#include "ostraka/library/edit.hpp"
#include "rebuilt_note.hpp"

namespace ostraka::app {
namespace {

struct BuildOptions {
    CommonOptions common;
    std::vector<std::string> models;
    std::string output;
    std::string unit;
    std::string fractions;
    std::string descriptors;
    std::string shard;
    std::string redundancy = "surface";
    bool bag_of_words = false;
    bool calibrate = false;
    LibrarySettings settings;
};

std::vector<AnyDescriptor> parse_descriptors(const std::string& text) {
    std::vector<AnyDescriptor> descriptors;
    std::string name;
    for (const char c : text + ",") {
        if (c != ',' && c != ' ') {
            name += c;
            continue;
        }
        if (name.empty()) continue;
        const auto descriptor = parse_descriptor(name);
        if (!descriptor) {
            throw CLI::ValidationError("--descriptors", "there is no descriptor " + name);
        }
        descriptors.push_back(*descriptor);
        name.clear();
    }
    return descriptors;
}

// "part.ply" or, in another unit than the library's, "part.ply:m".
ModelInput input_in_unit(const std::string& argument, std::optional<Unit> unit) {
    const std::size_t colon = argument.rfind(':');
    const bool plain = colon == std::string::npos || std::filesystem::exists(argument);
    const std::optional<Unit> own =
        plain ? std::nullopt : parse_unit(std::string_view(argument).substr(colon + 1));
    const std::filesystem::path path = own ? argument.substr(0, colon) : argument;
    if (!std::filesystem::exists(path)) throw FileError(path, "no such file");
    ModelInput input = model_input(path);
    if (!own || !unit)
        return tell_rebuilt(
            std::move(input));  // a missing --unit is reported later, with the models' sizes
    const auto factor = static_cast<float>(unit_factor(*own, *unit));
    input.file = std::filesystem::path(argument).filename().string();
    input.load = [path, factor, file = input.file] {
        ModelSource model = load_model(path);
        for (Vec3f& vertex : model.mesh.vertices) vertex *= factor;
        model.cloud_spacing *= double{factor};
        model.file = file;
        return model;
    };
    return tell_rebuilt(std::move(input));
}

struct Shard {
    std::size_t number = 0;  // from 0
    std::size_t count = 1;
};

Shard parse_shard(const std::string& text) {
    Shard shard;
    if (text.empty()) return shard;
    char end = '\0';
    if (std::sscanf(text.c_str(), "%zu/%zu%c", &shard.number, &shard.count, &end) != 2 ||
        shard.number < 1 || shard.number > shard.count) {
        throw CLI::ValidationError("--shard", text + " is not like 2/4");
    }
    --shard.number;
    return shard;
}

// Every count-th model by name. What is derived from all models is worked out before.
std::vector<ModelInput> models_of_shard(std::vector<ModelInput> models, const Shard& shard,
                                        LibrarySettings& settings) {
    std::sort(models.begin(), models.end(),
              [](const auto& a, const auto& b) { return a.name < b.name; });
    require_distinct_names(models);
    if (shard.count == 1) return models;
    if (settings.sampling == 0.0) settings.sampling = default_sampling(models);
    std::vector<ModelInput> mine;
    for (std::size_t i = shard.number; i < models.size(); i += shard.count) {
        mine.push_back(std::move(models[i]));
    }
    if (mine.empty()) {
        throw InvalidInput(fmt::format("shard {} of {} has none of the {} models: use fewer shards",
                                       shard.number + 1, shard.count, models.size()));
    }
    return mine;
}

std::string size_hint(const std::vector<ModelInput>& models) {
    double least = std::numeric_limits<double>::max();
    double most = 0.0;
    for (const ModelInput& model : models) {
        const double diameter = measure(model.load().mesh).diameter;
        least = std::min(least, diameter);
        most = std::max(most, diameter);
    }
    return fmt::format("the models measure {:.4g} to {:.4g} units across", least, most);
}

std::size_t count_entries(const BuildOutcome& built) {
    std::size_t entries = 0;
    for (const ModelSummary& model : built.models) {
        entries += static_cast<std::size_t>(model.counts.kept);
    }
    return entries;
}

void say_summary(const BuildOutcome& built) {
    std::vector<std::vector<std::string>> rows = {{"model", "diameter", "views", "cuts",
                                                   "too small", "redundant", "beyond budget",
                                                   "kept", "coverage"}};
    for (const ModelSummary& model : built.models) {
        const BuildCounts& c = model.counts;
        rows.push_back(
            {model.name, fmt::format("{:.4g} {}", model.diameter, unit_name(built.settings.unit)),
             std::to_string(c.views), std::to_string(c.cuts), std::to_string(c.too_small),
             std::to_string(c.redundant), std::to_string(c.beyond_budget), std::to_string(c.kept),
             fmt::format("{:.3f}", c.coverage)});
    }
    say_table(rows);
}

Json summary_json(const BuildOutcome& built, const std::string& file, double seconds) {
    Json models = Json::array();
    for (const ModelSummary& model : built.models) {
        const BuildCounts& c = model.counts;
        models.push_back({{"model", model.name},
                          {"diameter", model.diameter},
                          {"views", c.views},
                          {"subparts_made", c.cuts},
                          {"dropped_too_small", c.too_small},
                          {"dropped_redundant", c.redundant},
                          {"dropped_beyond_budget", c.beyond_budget},
                          {"kept", c.kept},
                          {"coverage", c.coverage},
                          {"covered", coverage_json(c)}});
    }
    return {{"library", file},
            {"unit", unit_name(built.settings.unit)},
            {"sampling", built.settings.sampling},
            {"entries", count_entries(built)},
            {"resumed", built.resumed},
            {"models", models},
            {"seconds", seconds}};
}

void run_build(BuildOptions& options) {
    catch_interrupts();
    const Stopwatch watch;
    LibrarySettings& settings = options.settings;
    if (!options.fractions.empty()) {
        settings.cuts.fractions = parse_numbers(options.fractions, "--fractions");
    }
    if (!options.descriptors.empty()) settings.descriptors = parse_descriptors(options.descriptors);
    if (options.calibrate && !options.shard.empty()) {
        throw CLI::ValidationError("--calibrate", "not of a shard: calibrate the merged library");
    }
    settings.selection.redundancy = *parse_redundancy(options.redundancy);
    const Shard shard = parse_shard(options.shard);
    std::vector<ModelInput> models;
    for (const std::string& path : options.models) {
        models.push_back(input_in_unit(path, parse_unit(options.unit)));
    }
    settings.unit = require_unit(options.unit, options.unit.empty() ? size_hint(models) : "");
    settings.views.sensor.seed = settings.seed;
    models = models_of_shard(std::move(models), shard, settings);
    const BuildOutcome built =
        build_library_file(models, settings, options.output, options.bag_of_words, progress_bar());
    say_summary(built);
    if (built.resumed > 0) {
        say(fmt::format("{} of {} models came from an unfinished build", built.resumed,
                        built.models.size()));
    }
    say(fmt::format("{}: {} models, {} entries, sampling {:.4g} {}, {:.1f} MB, {:.1f} s",
                    options.output, built.models.size(), count_entries(built),
                    built.settings.sampling, unit_name(built.settings.unit),
                    double(std::filesystem::file_size(options.output)) / 1e6, watch.seconds()));
    if (options.calibrate) {
        say(fmt::format("{}: graph of {} keypoint rows", options.output,
                        index_keypoints(options.output)));
        calibrate_library(options.output, {});
    }
    write_json(summary_json(built, options.output, watch.seconds()), options.common.json);
}

}  // namespace

void add_build(CLI::App& app) {
    auto options = std::make_shared<BuildOptions>();
    CLI::App* command = app.add_subcommand(
        "build", "make a library of CAD models; the same command goes on after an interruption");
    command
        ->add_option(
            "models", options->models,
            "mesh files: PLY, OBJ, STL, OFF, glTF, or clouds seen from all around: PLY, PCD, XYZ; "
            "with :mm, :cm, :m or :in behind the name "
            "where the unit is not --unit")
        ->required();
    command->add_option("-o,--output", options->output, "library file to write")->required();
    add_unit(*command, options->unit, "unit of the numbers in the model files");
    LibrarySettings& settings = options->settings;
    command
        ->add_option("--views", settings.views.count,
                     "viewpoints around each model: 12, 20, 42, 80, 162, 320, 642, ...")
        ->capture_default_str();
    command->add_option("--sampling", settings.sampling,
                        "distance between points, in --unit (default: 1 % of the median diameter)");
    command->add_option("--descriptors", options->descriptors,
                        "comma-separated: vfh,esf,gasd,shot,rops (default: all)");
    command->add_option("--directions", settings.cuts.directions, "cut directions: 6, 14 or 26")
        ->capture_default_str();
    command->add_option("--fractions", options->fractions,
                        "shares of the length that cuts keep (default: 0.35,0.5,0.65,0.8)");
    command->add_flag("--full-views-only", settings.full_views_only,
                      "the traditional library: whole views, no subparts");
    command->add_option("--budget", settings.selection.budget, "entries kept for each model")
        ->capture_default_str();
    command
        ->add_option("--redundancy", options->redundancy,
                     "how entries are chosen: surface (those that cover most), icp (the study's: "
                     "what ICP lays onto another is dropped) or none; with the latter two a budget "
                     "of 0 keeps all")
        ->check(CLI::IsMember({"surface", "icp", "none"}))
        ->capture_default_str();
    command
        ->add_option(
            "--spread", settings.selection.spread,
            "principal directions in which what an entry stands for varies, which it is "
            "compared with; 0 builds in half the time and recognizes by keypoints as well, "
            "by global descriptors much less")
        ->check(CLI::Range(0, kMostSpreadDirections))
        ->capture_default_str();
    command->add_option("--seed", settings.seed, "seed of every random step")
        ->capture_default_str();
    command->add_flag("--bag-of-words", options->bag_of_words,
                      "also learn a codebook of local descriptors, for `classify --descriptor "
                      "bag_of_words`");
    command->add_flag("--calibrate", options->calibrate,
                      "then do what `ostraka index` and `ostraka calibrate` do, so that scans are "
                      "searched faster and confidence is this library's own: about a minute more");
    command->add_option("--shard", options->shard,
                        "build the i-th of n shares of the models, as 2/4, for `ostraka merge`: "
                        "give every shard all models");
    add_common(*command, options->common);
    command->callback([options] { run_build(*options); });
}

}  // namespace ostraka::app
