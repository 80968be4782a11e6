// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/candidates.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "ostraka/base/parallel.hpp"
#include "ostraka/library/icp_redundancy.hpp"
#include "ostraka/library/surface_elements.hpp"
#include "ostraka/mesh/symmetry_poses.hpp"

namespace ostraka {
namespace {

constexpr int kAxisSteps = 12;           // turns about a continuous axis that stand for all
constexpr std::size_t kMostImages = 24;  // symmetric images that a piece is compared with

constexpr std::size_t kMostCompanions = 32;  // of an entry: all of them (about 40) cost more time
                                             // than they gain

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

// The candidates of all views, and what each shows.
struct Pool {
    std::vector<Candidate> candidates;
    std::vector<ElementSet> shown;
};

Pool gather(std::vector<ViewCandidates>& of_view, BuildCounts& counts) {
    Pool pool;
    for (ViewCandidates& view : of_view) {
        std::move(view.candidates.begin(), view.candidates.end(),
                  std::back_inserter(pool.candidates));
        pool.shown.insert(pool.shown.end(), view.shown.begin(), view.shown.end());
        counts.cuts += static_cast<int>(view.made);
        counts.too_small += static_cast<int>(view.too_small);
    }
    return pool;
}

std::vector<ElementMap> images(const SurfaceElements& elements, const Symmetry& symmetry) {
    std::vector<ElementMap> maps;
    if (!symmetry.any()) return maps;
    const std::vector<Pose> motions = symmetry_motions(symmetry, kAxisSteps);
    for (const std::uint32_t i : thin_out(motions.size(), kMostImages)) {
        if (!motions[i].isApprox(Pose::Identity(), 1e-9)) maps.push_back(elements.map(motions[i]));
    }
    return maps;
}

// Of the candidates in `kept`, as many as the budget allows.
SelectionResult thinned(const std::vector<std::uint32_t>& kept, std::size_t total, int budget) {
    SelectionResult result;
    for (const std::uint32_t i : thin_out(kept.size(), static_cast<std::size_t>(budget))) {
        result.chosen.push_back(kept[i]);
    }
    result.redundant = total - kept.size();
    result.beyond_budget = kept.size() - result.chosen.size();
    return result;
}

SelectionResult select(const Pool& pool, std::span<const ModelView> views,
                       const SurfaceElements& elements, const Symmetry& symmetry,
                       const LibrarySettings& settings) {
    const std::size_t total = pool.candidates.size();
    std::vector<std::uint32_t> all(total);
    std::iota(all.begin(), all.end(), 0U);
    if (settings.full_views_only) return thinned(all, total, 0);
    switch (settings.selection.redundancy) {
        case Redundancy::none:
            return thinned(all, total, settings.selection.budget);
        case Redundancy::icp: {
            std::vector<PointCloud> clouds(total);
            parallel_for(total, [&](std::size_t i) {
                const Candidate& candidate = pool.candidates[i];
                clouds[i] = ostraka::select(views[candidate.view].cloud, candidate.indices);
            });
            return thinned(drop_by_icp(clouds, settings.sampling), total,
                           settings.selection.budget);
        }
        case Redundancy::surface:
            break;
    }
    return select_entries(pool.shown, settings.selection, images(elements, symmetry));
}

bool needs_triangles(const LibrarySettings& settings) {
    return std::any_of(settings.descriptors.begin(), settings.descriptors.end(),
                       [](const AnyDescriptor& descriptor) {
                           return std::holds_alternative<GlobalRopsSettings>(descriptor);
                       });
}

// Those of a view whose corners are all in a piece of it.
PieceTriangles triangles_within(const PieceTriangles& of_view, std::size_t points,
                                const std::vector<std::uint32_t>& piece) {
    std::vector<std::uint32_t> place(points, kNoIndex);
    for (std::uint32_t i = 0; i < piece.size(); ++i) place[piece[i]] = i;
    PieceTriangles result;
    for (const IndexTriangle& triangle : of_view) {
        const IndexTriangle moved = {place[triangle[0]], place[triangle[1]], place[triangle[2]]};
        if (std::find(moved.begin(), moved.end(), kNoIndex) == moved.end()) result.push_back(moved);
    }
    return result;
}

// Of each view; empty ones if no descriptor needs any.
std::vector<PieceTriangles> triangulate_views(std::span<const ModelView> views,
                                              const LibrarySettings& settings) {
    std::vector<PieceTriangles> triangles(views.size());
    if (!needs_triangles(settings)) return triangles;
    parallel_for(views.size(), [&](std::size_t v) {
        if (views[v].cloud.size() >= 3) triangles[v] = triangulate(views[v].cloud);
    });
    return triangles;
}

// The candidates that each entry stands for, or some of them, evenly; itself excepted.
std::vector<Companion> companions(Pool& pool, const SelectionResult& selected) {
    std::vector<std::vector<std::uint32_t>> of_entry(selected.chosen.size());
    for (std::uint32_t i = 0; i < selected.nearest.size(); ++i) {
        const std::uint32_t entry = selected.nearest[i];
        if (entry != kNoIndex && selected.chosen[entry] != i) of_entry[entry].push_back(i);
    }
    std::vector<Companion> result;
    for (std::uint32_t e = 0; e < of_entry.size(); ++e) {
        for (const std::uint32_t k : thin_out(of_entry[e].size(), kMostCompanions)) {
            Candidate& candidate = pool.candidates[of_entry[e][k]];
            result.push_back({e, candidate.view, std::move(candidate.indices)});
        }
    }
    return result;
}

}  // namespace

Choice choose_entries(std::span<const ModelView> views, const PointCloud& surface,
                      const Symmetry& symmetry, const LibrarySettings& settings,
                      BuildCounts& counts) {
    const SurfaceElements elements(surface);
    std::vector<ViewCandidates> of_view(views.size());
    parallel_for(views.size(), [&](std::size_t v) {
        if (views[v].cloud.size() < 3) return;  // an edge-on plate may show next to nothing
        of_view[v] = candidates_of(views[v], v, elements, settings);
    });
    Pool pool = gather(of_view, counts);
    const SelectionResult selected = select(pool, views, elements, symmetry, settings);
    counts.views = static_cast<int>(views.size());
    counts.redundant = static_cast<int>(selected.redundant);
    counts.beyond_budget = static_cast<int>(selected.beyond_budget);
    counts.kept = static_cast<int>(selected.chosen.size());
    counts.coverage = selected.coverage;
    counts.covered = selected.covered;
    Choice choice;
    choice.view_triangles = triangulate_views(views, settings);
    for (const std::uint32_t i : selected.chosen) {
        const Candidate& candidate = pool.candidates[i];
        choice.entries.push_back(make_entry(candidate, views[candidate.view]));
        choice.triangles.push_back(triangles_within(choice.view_triangles[candidate.view],
                                                    views[candidate.view].cloud.size(),
                                                    candidate.indices));
    }
    if (settings.selection.spread > 0) choice.companions = companions(pool, selected);
    return choice;
}

Piece piece_of(const Companion& companion, std::span<const ModelView> views, const Choice& choice) {
    const PointCloud& view = views[companion.view].cloud;
    return {select(view, companion.indices), triangles_within(choice.view_triangles[companion.view],
                                                              view.size(), companion.indices)};
}

}  // namespace ostraka
