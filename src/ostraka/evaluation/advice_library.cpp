// SPDX-License-Identifier: Apache-2.0
// The library that suits: several are built and tried on the same segments.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "ostraka/base/error.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/evaluation/advice_steps.hpp"
#include "ostraka/evaluation/run.hpp"
#include "ostraka/library/library_file.hpp"

namespace ostraka {
namespace {

constexpr double kCoarser = 1.5;    // the second sampling distance, in the first
constexpr double kLeastStep = 1.1;  // less isn't worth a trial
constexpr int kBudgets[] = {24, 48, 96};
constexpr std::size_t kUsual = 1;  // of settings_to_try(): the first sampling distance and 48

std::vector<std::string> names_of(const std::vector<AnyDescriptor>& descriptors) {
    std::vector<std::string> names;
    for (const AnyDescriptor& descriptor : descriptors) {
        names.emplace_back(descriptor_name(descriptor));
    }
    return names;
}

std::uint64_t file_size_of(const ModelLibrary& library) {
    const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                       fmt::format("ostraka_advise_{}.ostraka", ::getpid());
    save_library(library, path);
    const std::uint64_t size = std::filesystem::file_size(path);
    std::filesystem::remove(path);
    return size;
}

SettingsTrial trial_of(const ModelLibrary& library, double seconds) {
    return {.sampling = library.settings.sampling,
            .budget = library.settings.selection.budget,
            .descriptors = names_of(library.settings.descriptors),
            .entries = library.entries.size(),
            .bytes = file_size_of(library),
            .build_seconds = seconds};
}

// @param most  sampling distance that the smallest part allows.
std::vector<LibrarySettings> settings_to_try(const AdviceSettings& settings, double most) {
    std::vector<LibrarySettings> all;
    if (!settings.compare) return {settings.library};
    const double first = settings.library.sampling;
    std::vector<double> samplings = {first};
    const double second = std::min(kCoarser * first, most);
    if (second > kLeastStep * first) samplings.push_back(second);
    for (const double sampling : samplings) {
        for (const int budget : kBudgets) {
            all.push_back(settings.library);
            all.back().sampling = sampling;
            all.back().selection.budget = budget;
        }
    }
    return all;
}

// The same library with some of its descriptors: as if it had been built with them only.
ModelLibrary with_descriptor(ModelLibrary library, std::size_t table) {
    library.settings.descriptors = {library.settings.descriptors[table]};
    library.tables = {std::move(library.tables[table])};
    return library;
}

// Protocol S of all libraries on the same segments. @return how many there were.
std::size_t try_libraries(const std::vector<ModelLibrary>& libraries,
                          const AdviceSettings& settings, double distance,
                          std::vector<SettingsTrial>& trials, const std::string& stage,
                          const Progress& progress) {
    const SceneModels models = scene_models_of(libraries.front());
    RandomViewSettings recipe{.distance = distance / mean_diameter(models),
                              .camera = settings.sensor.camera,
                              .sensor = settings.sensor.model,
                              .seed = settings.seed};
    recipe.sensor.ranging.seed = settings.seed;
    const TestSet set =
        simulated_set(libraries.front(), recipe, static_cast<std::size_t>(settings.segment_scenes));
    std::vector<EntryIndex> indices;
    indices.reserve(libraries.size());
    std::vector<const EntryIndex*> pointers;
    for (const ModelLibrary& library : libraries) {
        pointers.push_back(&indices.emplace_back(library));
    }
    Journal journal("", "");
    const auto results = run_segments(pointers, set, {}, journal,
                                      [&](std::string_view, std::size_t done, std::size_t total) {
                                          return !progress || progress(stage, done, total);
                                      });
    for (std::size_t i = 0; i < results.size(); ++i) {
        for (const std::string& method : methods_of(libraries[i])) {
            trials[i].rates[method] = recognition_rate(results[i], method, 0);
        }
    }
    return results.front().size();
}

}  // namespace

std::size_t cheapest_good(std::span<const SettingsTrial> trials) {
    if (trials.empty()) throw InvalidInput("there are no settings to choose from");
    const auto best = std::max_element(
        trials.begin(), trials.end(),
        [](const auto& a, const auto& b) { return a.fused().value < b.fused().value; });
    std::size_t chosen = static_cast<std::size_t>(best - trials.begin());
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const bool good = trials[i].fused().value >= best->fused().low;
        const bool smaller = trials[i].bytes < trials[chosen].bytes ||
                             (trials[i].bytes == trials[chosen].bytes && i < chosen);
        if (good && smaller) chosen = i;
    }
    return chosen;
}

Candidates choose_library(std::span<const ModelSource> models, const AdviceSettings& settings,
                          double distance, Advice& advice, const Progress& progress) {
    const std::vector<LibrarySettings> to_try = settings_to_try(settings, advice.sampling.most);
    std::vector<ModelLibrary> libraries;
    for (std::size_t i = 0; i < to_try.size(); ++i) {
        const std::string stage = fmt::format("library {} of {}", i + 1, to_try.size());
        const Stopwatch watch;
        libraries.push_back(build_library(
            models, to_try[i], [&](std::string_view, std::size_t done, std::size_t total) {
                return !progress || progress(stage, done, total);
            }));
        advice.trials.push_back(trial_of(libraries.back(), watch.seconds()));
    }
    advice.segments =
        try_libraries(libraries, settings, distance, advice.trials, "segments", progress);
    advice.chosen = cheapest_good(advice.trials);
    Candidates candidates{std::move(libraries[advice.chosen]), std::nullopt};
    if (settings.compare && advice.chosen != kUsual) {
        candidates.usual = std::move(libraries[kUsual]);
    }
    libraries.clear();
    if (settings.compare && candidates.small.tables.size() > 1) {
        libraries.push_back(candidates.small);
        for (std::size_t t = 0; t < candidates.small.tables.size(); ++t) {
            libraries.push_back(with_descriptor(candidates.small, t));
        }
        for (const ModelLibrary& library : libraries) {
            advice.descriptor_trials.push_back(trial_of(library, -1.0));
        }
        try_libraries(libraries, settings, distance, advice.descriptor_trials, "descriptors",
                      progress);
        advice.chosen_descriptors = cheapest_good(advice.descriptor_trials);
        if (advice.chosen_descriptors > 0) {
            if (!candidates.usual) candidates.usual = std::move(candidates.small);
            candidates.small = std::move(libraries[advice.chosen_descriptors]);
        }
    }
    return candidates;
}

ModelLibrary confirm_library(Candidates candidates, const AdviceSettings& settings, double distance,
                             Advice& advice, HeapRecords& known, const Progress& progress) {
    if (!candidates.usual) return std::move(candidates.small);
    std::vector<SceneRecord> small =
        recognize_heaps(candidates.small, settings, distance, "small library", progress);
    std::vector<SceneRecord> usual =
        recognize_heaps(*candidates.usual, settings, distance, "usual library", progress);
    Confirmation& confirmation = advice.confirmation;
    confirmation.made = true;
    confirmation.small = summarize(small, candidates.small, settings.match).recall;
    confirmation.usual = summarize(usual, *candidates.usual, settings.match).recall;
    std::vector<double> more;
    std::vector<double> objects;
    for (std::size_t s = 0; s < small.size(); ++s) {
        const Matching a = match(small[s], candidates.small, settings.match);
        const Matching b = match(usual[s], *candidates.usual, settings.match);
        more.push_back(static_cast<double>(b.hits.size()) - static_cast<double>(a.hits.size()));
        objects.push_back(static_cast<double>(a.hits.size() + a.misses.size()));
    }
    confirmation.loss = bootstrap_ratio(more, objects);
    confirmation.kept = confirmation.loss.value < kMostLoss;
    known[distance] = confirmation.kept ? std::move(small) : std::move(usual);
    return confirmation.kept ? std::move(candidates.small) : std::move(*candidates.usual);
}

}  // namespace ostraka
