// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>

#include "ostraka/base/parallel.hpp"
#include "ostraka/library/build_record.hpp"
#include "ostraka/views/viewpoints.hpp"

namespace ostraka {
namespace {

// Counts finished steps of all threads; lets one thread at a time report them.
class SharedProgress {
  public:
    SharedProgress(const Progress& progress, std::string_view stage, std::size_t total)
        : progress_(progress), stage_(stage), total_(total) {}
    void step(std::size_t count) {
        const std::scoped_lock lock(mutex_);
        done_ += count;
        report(progress_, stage_, done_, total_);
    }

  private:
    const Progress& progress_;
    std::string_view stage_;
    std::size_t total_;
    std::size_t done_ = 0;
    std::mutex mutex_;
};

// Models in memory at a time: enough to keep the threads busy, as each model is built by all.
constexpr std::size_t kModelsInFlight = 8;

}  // namespace

LibrarySettings complete_settings(LibrarySettings settings) {
    if (!(settings.sampling > 0.0)) throw InvalidInput("sampling must be positive");
    const bool unlimited = settings.selection.redundancy != Redundancy::surface;
    if (settings.selection.budget < (unlimited ? 0 : 1)) {
        throw InvalidInput("budget must be at least 1");
    }
    if (settings.selection.spread < 0 || settings.selection.spread > kMostSpreadDirections) {
        throw InvalidInput(fmt::format("spread must be 0 to {} directions", kMostSpreadDirections));
    }
    for (const double fraction : settings.cuts.fractions) {
        if (!(fraction > 0.0 && fraction < 1.0)) {
            throw InvalidInput(fmt::format("cut fraction {:g} is not between 0 and 1", fraction));
        }
    }
    if (settings.descriptors.empty()) throw InvalidInput("a library needs at least one descriptor");
    for (const AnyDescriptor& descriptor : settings.descriptors) {
        if (descriptor_kind(descriptor) == DescriptorKind::global) continue;
        throw InvalidInput(fmt::format(
            "a library's entries have one row each, {} is a {} descriptor",
            descriptor_name(descriptor), descriptor_kind_name(descriptor_kind(descriptor))));
    }
    for (const AnyDescriptor& descriptor : settings.descriptors) {
        if (descriptor_name(descriptor) != "gasd_color") continue;
        throw InvalidInput("a library has no gasd_color: virtual views have no colors");
    }
    viewpoints(settings.views.count);
    cut_directions(settings.cuts.directions);
    settings.views.sampling = settings.sampling;
    if (settings.cuts.cluster_tolerance == 0.0) {
        settings.cuts.cluster_tolerance = 2.0 * settings.sampling;
    }
    return settings;
}

double default_sampling(std::span<const ModelInput> models) {
    std::vector<double> diameters(models.size());
    std::vector<ModelSource> sources(models.size());
    ordered_pipeline(
        models.size(), kModelsInFlight, [&](std::size_t i) { sources[i] = models[i].load(); },
        [&](std::size_t i) {
            diameters[i] = measure(sources[i].mesh).diameter;
            sources[i] = {};
        },
        [](std::size_t) {});
    std::sort(diameters.begin(), diameters.end());
    return diameters.empty() ? 0.0 : 0.01 * diameters[diameters.size() / 2];
}

void build_records(std::span<const ModelInput> models, const LibrarySettings& settings,
                   const RecordSink& sink, const Progress& progress) {
    const auto views = static_cast<std::size_t>(settings.views.count);
    // Half of a model's share of the bar for looking at it, the other half for the rest.
    SharedProgress shared(progress, "models", 2 * views * models.size());
    std::vector<ModelSource> sources(models.size());
    std::vector<ModelRecord> records(models.size());
    ordered_pipeline(
        models.size(), std::min(kModelsInFlight, thread_count()),
        [&](std::size_t m) { sources[m] = models[m].load(); },
        [&](std::size_t m) {
            records[m] = build_record(sources[m], settings, [&](std::size_t n) { shared.step(n); });
            sources[m] = {};
        },
        [&](std::size_t m) {
            sink(std::move(records[m]));
            shared.step(views);
        });
}

ModelLibrary build_library(std::span<const ModelSource> models, const LibrarySettings& settings,
                           const Progress& progress) {
    if (models.empty()) throw InvalidInput("a library needs at least one model");
    std::vector<ModelInput> inputs;
    for (const ModelSource& source : models) inputs.push_back(model_input(source));
    LibrarySettings complete = settings;
    if (complete.sampling == 0.0) complete.sampling = default_sampling(inputs);
    complete = complete_settings(complete);
    require_distinct_names(inputs);
    std::vector<ModelRecord> records;
    build_records(
        inputs, complete, [&](ModelRecord record) { records.push_back(std::move(record)); },
        progress);
    return join_records(complete, std::move(records));
}

void require_distinct_names(std::span<const ModelInput> models) {
    std::vector<std::string> names;
    for (const ModelInput& model : models) names.push_back(model.name);
    std::sort(names.begin(), names.end());
    const auto twice = std::adjacent_find(names.begin(), names.end());
    if (twice == names.end()) return;
    throw InvalidInput(fmt::format("two models are named {}: names must differ", *twice));
}

const DescriptorTable* find_table(const ModelLibrary& library, std::string_view descriptor) {
    for (const DescriptorTable& table : library.tables) {
        if (descriptor_name(table.descriptor) == descriptor) return &table;
    }
    return nullptr;
}

}  // namespace ostraka
