// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <numeric>

#include "ostraka/base/parallel.hpp"
#include "ostraka/library/encoding.hpp"
#include "ostraka/library/keypoints.hpp"
#include "ostraka/library/model_surface.hpp"
#include "ostraka/views/viewpoints.hpp"

namespace ostraka {
namespace {

// Counts finished steps of all threads; lets one thread at a time report them.
class SharedProgress {
  public:
    SharedProgress(const Progress& progress, std::string_view stage, std::size_t total)
        : progress_(progress), stage_(stage), total_(total) {}
    void step() {
        const std::scoped_lock lock(mutex_);
        report(progress_, stage_, ++done_, total_);
    }

  private:
    const Progress& progress_;
    std::string_view stage_;
    std::size_t total_;
    std::size_t done_ = 0;
    std::mutex mutex_;
};

// A whole view or a subpart of one, before it is chosen.
struct Candidate {
    std::size_t view = 0;
    int direction = -1;
    int fraction = -1;
    std::vector<std::uint32_t> indices;  // into the view's cloud
};

struct ViewCandidates {
    std::vector<Candidate> candidates;
    std::vector<ElementSet> shown;
    std::size_t made = 0;
    std::size_t too_small = 0;
};

struct BuiltModel {
    Model model;
    std::vector<Entry> entries;
};

ViewCandidates candidates_of(const ModelView& view, std::size_t view_number,
                             const SurfaceElements& elements, const LibrarySettings& settings) {
    ViewCandidates result;
    std::vector<std::uint32_t> all(view.cloud.size());
    std::iota(all.begin(), all.end(), 0U);
    const std::vector<std::uint32_t> labels = elements.label(view.cloud);
    result.shown.push_back(element_set(labels, all));
    result.candidates.push_back({view_number, -1, -1, std::move(all)});
    if (settings.full_views_only) return result;
    CutResult cuts = cut_view(view.cloud, principal_frame(view.cloud), settings.cuts);
    for (Subpart& subpart : cuts.subparts) {
        result.shown.push_back(element_set(labels, subpart.indices));
        result.candidates.push_back(
            {view_number, subpart.direction, subpart.fraction, std::move(subpart.indices)});
    }
    result.made = cuts.made;
    result.too_small = cuts.dropped_by_size;
    return result;
}

Entry make_entry(const Candidate& candidate, const ModelView& view) {
    Entry entry;
    entry.view = view.index;
    entry.direction = candidate.direction;
    entry.fraction = candidate.fraction;
    entry.cloud = select(view.cloud, candidate.indices);
    entry.frame = principal_frame(entry.cloud);
    return entry;
}

std::vector<Entry> choose_entries(const std::vector<ModelView>& views, const PointCloud& surface,
                                  const LibrarySettings& settings, BuildCounts& counts) {
    const SurfaceElements elements(surface);
    std::vector<ViewCandidates> of_view(views.size());
    parallel_for(views.size(), [&](std::size_t v) {
        if (views[v].cloud.size() < 3) return;  // an edge-on plate may show next to nothing
        of_view[v] = candidates_of(views[v], v, elements, settings);
    });
    std::vector<Candidate> candidates;
    std::vector<ElementSet> shown;
    for (ViewCandidates& view : of_view) {
        std::move(view.candidates.begin(), view.candidates.end(), std::back_inserter(candidates));
        shown.insert(shown.end(), view.shown.begin(), view.shown.end());
        counts.cuts += static_cast<int>(view.made);
        counts.too_small += static_cast<int>(view.too_small);
    }
    SelectionSettings selection = settings.selection;
    if (settings.full_views_only) selection = {.budget = settings.views.count, .max_overlap = 2.0};
    const SelectionResult selected = select_entries(shown, selection);
    counts.views = static_cast<int>(views.size());
    counts.redundant = static_cast<int>(selected.redundant);
    counts.beyond_budget = static_cast<int>(selected.beyond_budget);
    counts.kept = static_cast<int>(selected.chosen.size());
    counts.coverage = selected.coverage;
    std::vector<Entry> entries;
    for (const std::uint32_t i : selected.chosen) {
        entries.push_back(make_entry(candidates[i], views[candidates[i].view]));
    }
    return entries;
}

// From the canonical frame, in which a model is looked at, to the frame of its file.
void to_model_frame(BuiltModel& built, const Pose& T_model_canonical) {
    const Mat3f R_model_canonical = T_model_canonical.linear().cast<float>();
    built.model.surface = transformed(built.model.surface, T_model_canonical);
    for (Vec3f& point : built.model.keypoints.points) {
        point = (T_model_canonical * point.cast<double>()).cast<float>();
    }
    for (Mat3f& frame : built.model.keypoints.frames) frame = R_model_canonical * frame;
    for (Entry& entry : built.entries) {
        entry.cloud = transformed(entry.cloud, T_model_canonical);
        entry.frame.T_cloud_frame = T_model_canonical * entry.frame.T_cloud_frame;
    }
}

BuiltModel build_model(const ModelSource& source, const LibrarySettings& settings,
                       SharedProgress& progress) {
    BuiltModel built;
    Model& model = built.model;
    model.name = source.name;
    model.file = source.file;
    model.sha256 = source.sha256;
    model.mesh = source.mesh;
    model.shape = measure(source.mesh);
    Pose T_model_canonical = Pose::Identity();
    T_model_canonical.linear() = model.shape.axes;
    T_model_canonical.translation() = model.shape.center;
    MeshShape canonical = model.shape;
    canonical.center.setZero();
    canonical.axes.setIdentity();
    const RayScene rays({transformed(source.mesh, T_model_canonical.inverse())});

    const auto count = static_cast<std::size_t>(settings.views.count);
    std::vector<RenderedView> rendered(count);
    std::vector<ModelView> views(count);
    parallel_for(count, [&](std::size_t v) {
        rendered[v] = render_view(rays, canonical, settings.views, static_cast<int>(v));
        views[v] = make_view(rendered[v], settings.views, static_cast<int>(v));
        progress.step();
    });
    model.surface = merge_surface(rendered, settings.sampling);
    if (model.surface.empty()) {
        throw InvalidInput(fmt::format("model {}: nothing of it can be seen at sampling {:.6g}",
                                       model.name, settings.sampling));
    }
    built.entries = choose_entries(views, model.surface, settings, model.counts);
    model.keypoints = describe_keypoints(model.surface, views, settings);
    to_model_frame(built, T_model_canonical);
    return built;
}

// Entries are kept as they will be stored, so that a library is the same before and after saving.
void strip(Entry& entry, const MeshShape& shape) {
    entry.cloud.normals.clear();
    for (Vec3f& point : entry.cloud.points) {
        point = decode_point(encode_point(point, shape), shape);
    }
}

DescriptorTable describe_entries(const std::vector<Entry>& entries, const AnyDescriptor& descriptor,
                                 SharedProgress& progress) {
    const std::size_t length = descriptor_length(descriptor);
    DescriptorTable table{descriptor, std::vector<float>(entries.size() * length)};
    parallel_for(entries.size(), [&](std::size_t i) {
        const std::vector<float> row = describe(entries[i].cloud, descriptor);
        std::copy(row.begin(), row.end(),
                  table.rows.begin() + static_cast<std::ptrdiff_t>(i * length));
        progress.step();
    });
    return table;
}

LibrarySettings completed(LibrarySettings settings, std::span<const ModelSource> models) {
    if (settings.sampling == 0.0) settings.sampling = default_sampling(models);
    if (!(settings.sampling > 0.0)) throw InvalidInput("sampling must be positive");
    if (settings.selection.budget < 1) throw InvalidInput("budget must be at least 1");
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
    viewpoints(settings.views.count);
    cut_directions(settings.cuts.directions);
    settings.views.sampling = settings.sampling;
    if (settings.cuts.cluster_tolerance == 0.0) {
        settings.cuts.cluster_tolerance = 2.0 * settings.sampling;
    }
    return settings;
}

std::vector<const ModelSource*> by_name(std::span<const ModelSource> models) {
    std::vector<const ModelSource*> sorted;
    for (const ModelSource& model : models) sorted.push_back(&model);
    std::sort(sorted.begin(), sorted.end(),
              [](const auto* a, const auto* b) { return a->name < b->name; });
    for (std::size_t i = 1; i < sorted.size(); ++i) {
        if (sorted[i]->name == sorted[i - 1]->name) {
            throw InvalidInput(
                fmt::format("two models are named {}: names must differ", sorted[i]->name));
        }
    }
    return sorted;
}

}  // namespace

double default_sampling(std::span<const ModelSource> models) {
    std::vector<double> diameters(models.size());
    parallel_for(models.size(),
                 [&](std::size_t i) { diameters[i] = measure(models[i].mesh).diameter; });
    std::sort(diameters.begin(), diameters.end());
    return diameters.empty() ? 0.0 : 0.01 * diameters[diameters.size() / 2];
}

ModelLibrary build_library(std::span<const ModelSource> models, const LibrarySettings& settings,
                           const Progress& progress) {
    if (models.empty()) throw InvalidInput("a library needs at least one model");
    const std::vector<const ModelSource*> sorted = by_name(models);
    ModelLibrary library;
    library.settings = completed(settings, models);
    const auto views = static_cast<std::size_t>(library.settings.views.count);
    SharedProgress view_progress(progress, "views", views * models.size());
    std::vector<BuiltModel> all(sorted.size());
    parallel_for(sorted.size(), [&](std::size_t m) {
        all[m] = build_model(*sorted[m], library.settings, view_progress);
    });
    for (BuiltModel& built : all) {
        for (Entry& entry : built.entries) {
            entry.model = static_cast<std::uint32_t>(library.models.size());
            library.entries.push_back(std::move(entry));
        }
        library.models.push_back(std::move(built.model));
    }
    SharedProgress describe_progress(progress, "descriptors",
                                     library.entries.size() * library.settings.descriptors.size());
    for (const AnyDescriptor& descriptor : library.settings.descriptors) {
        library.tables.push_back(describe_entries(library.entries, descriptor, describe_progress));
    }
    for (Entry& entry : library.entries) strip(entry, library.models[entry.model].shape);
    return library;
}

const DescriptorTable* find_table(const ModelLibrary& library, std::string_view descriptor) {
    for (const DescriptorTable& table : library.tables) {
        if (descriptor_name(table.descriptor) == descriptor) return &table;
    }
    return nullptr;
}

}  // namespace ostraka
