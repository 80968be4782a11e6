// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/candidates.hpp"

#include <iterator>
#include <numeric>

#include "ostraka/base/parallel.hpp"
#include "ostraka/library/surface_elements.hpp"

namespace ostraka {
namespace {

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

}  // namespace

std::vector<Entry> choose_entries(std::span<const ModelView> views, const PointCloud& surface,
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
    counts.covered = selected.covered;
    std::vector<Entry> entries;
    for (const std::uint32_t i : selected.chosen) {
        entries.push_back(make_entry(candidates[i], views[candidates[i].view]));
    }
    return entries;
}

}  // namespace ostraka
