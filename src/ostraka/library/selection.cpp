// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/selection.hpp"

#include <algorithm>
#include <array>
#include <queue>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/vector_clones.hpp"
#include "ostraka/library/element_table.hpp"

namespace ostraka {
namespace {

constexpr std::array<std::string_view, 3> kNames = {"surface", "icp", "none"};

// Raises each of `row` to the overlap of a set of `size` elements with one of `sizes`.
OSTRAKA_VECTOR_CLONES void raise_ratios(int size, std::span<const int> sizes,
                                        std::span<const int> common, std::span<float> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
        const int either = std::max(1, size + sizes[i] - common[i]);
        row[i] = std::max(row[i], static_cast<float>(common[i]) / static_cast<float>(either));
    }
}

// Overlaps of a set, or its best image, with each of many.
class OverlapRow {
  public:
    explicit OverlapRow(std::span<const ElementMap> images) : images_(images) {}

    void add(const ElementSet& set) { sets_.add(set); }
    std::size_t size() const { return sets_.size(); }
    /// Intersection over union of `set` with each, into `row` (replaced).
    void with(const ElementSet& set, std::vector<float>& row) const {
        row.assign(sets_.size(), 0.0F);
        raise(set, row);
        for (const ElementMap& image : images_) raise(mapped(set, image), row);
    }
    /// The earliest one that `set` overlaps by at least `least`, and most of all; kNoIndex: none.
    std::uint32_t most_alike(const ElementSet& set, double least) const {
        std::uint32_t best = kNoIndex;
        double most = 0.0;
        seek(set, least, best, most);
        for (const ElementMap& image : images_) seek(mapped(set, image), least, best, most);
        return best;
    }

  private:
    void raise(const ElementSet& set, std::vector<float>& row) const {
        thread_local std::vector<int> common;
        sets_.count_common(set, common);
        raise_ratios(count_elements(set), sets_.counts(), common, row);
    }
    void seek(const ElementSet& set, double least, std::uint32_t& best, double& most) const {
        thread_local std::vector<int> common;
        sets_.count_common(set, common);
        const int size = count_elements(set);
        const double clearly_less = least - 1e-6;  // spares most of the divisions
        for (std::uint32_t i = 0; i < common.size(); ++i) {
            const int either = std::max(1, size + sets_.counts()[i] - common[i]);
            if (common[i] < clearly_less * either) continue;
            const double found = static_cast<double>(common[i]) / either;
            if (found < least || found < most || (found == most && i >= best)) continue;
            best = i;
            most = found;
        }
    }

    std::span<const ElementMap> images_;
    ElementTable sets_;
};

// Candidates that differ, and how many candidates each of them stands for, itself included.
struct Ground {
    std::vector<std::uint32_t> candidates;
    std::vector<double> weights;
};

Ground drop_redundant(std::span<const ElementSet> candidates, double max_overlap,
                      std::span<const ElementMap> images) {
    Ground ground;
    OverlapRow kept_sets(images);
    for (std::uint32_t i = 0; i < candidates.size(); ++i) {
        const std::uint32_t alike = kept_sets.most_alike(candidates[i], max_overlap);
        if (alike != kNoIndex) {
            ground.weights[alike] += 1.0;
            continue;
        }
        ground.candidates.push_back(i);
        ground.weights.push_back(1.0);
        kept_sets.add(candidates[i]);
    }
    return ground;
}

// Weighted sum of what `row` adds to `covered`. Four partial sums in a fixed order.
double gain_over(std::span<const float> row, std::span<const float> covered,
                 std::span<const double> weights) {
    std::array<double, 4> sums{};
    for (std::size_t o = 0; o < row.size(); ++o) {
        sums[o % 4] += weights[o] * double{std::max(0.0F, row[o] - covered[o])};
    }
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

// A candidate with an upper bound of its gain; ties go to the earlier candidate.
struct Bound {
    double gain = 0.0;
    std::uint32_t candidate = 0;
    std::size_t round = 0;  // the number of chosen entries when the gain was worked out
    bool operator<(const Bound& other) const {
        return gain != other.gain ? gain < other.gain : candidate > other.candidate;
    }
};

}  // namespace

std::string_view redundancy_name(Redundancy redundancy) {
    return kNames[static_cast<std::size_t>(redundancy)];
}

std::optional<Redundancy> parse_redundancy(std::string_view name) {
    for (std::size_t i = 0; i < kNames.size(); ++i) {
        if (kNames[i] == name) return static_cast<Redundancy>(i);
    }
    return std::nullopt;
}

std::vector<std::uint32_t> thin_out(std::size_t total, std::size_t count) {
    if (count == 0 || count > total) count = total;
    std::vector<std::uint32_t> indices(count);
    for (std::size_t i = 0; i < count; ++i) {
        indices[i] = static_cast<std::uint32_t>(i * total / count);
    }
    return indices;
}

SelectionResult select_entries(std::span<const ElementSet> candidates,
                               const SelectionSettings& settings,
                               std::span<const ElementMap> images) {
    const Ground ground = drop_redundant(candidates, settings.max_overlap, images);
    const std::size_t count = ground.candidates.size();
    std::vector<float> covered(count, 0.0F);
    std::vector<std::uint32_t> coverer(count, kNoIndex);  // candidate that covers most
    OverlapRow all(images);
    for (const std::uint32_t i : ground.candidates) all.add(candidates[i]);
    const auto gain_of = [&](std::uint32_t candidate, std::vector<float>& row) {
        all.with(candidates[candidate], row);
        return gain_over(row, covered, ground.weights);
    };
    std::vector<double> gains(count);
    parallel_for(
        count,
        [&](std::size_t i) {
            thread_local std::vector<float> row;
            gains[i] = gain_of(ground.candidates[i], row);
        },
        32);
    std::priority_queue<Bound> queue;
    for (std::size_t i = 0; i < count; ++i) queue.push({gains[i], ground.candidates[i], 0});
    std::vector<float> row;
    SelectionResult result;
    result.redundant = candidates.size() - count;
    const auto budget = static_cast<std::size_t>(std::max(0, settings.budget));
    while (!queue.empty() && result.chosen.size() < budget) {
        const Bound top = queue.top();
        queue.pop();
        const double gain = gain_of(top.candidate, row);
        if (top.round != result.chosen.size()) {
            queue.push({gain, top.candidate, result.chosen.size()});
            continue;
        }
        for (std::size_t o = 0; o < covered.size(); ++o) {
            if (row[o] <= covered[o] && coverer[o] != kNoIndex) continue;
            covered[o] = row[o];
            coverer[o] = top.candidate;
        }
        result.chosen.push_back(top.candidate);
    }
    std::sort(result.chosen.begin(), result.chosen.end());
    result.beyond_budget = count - result.chosen.size();
    result.nearest.assign(candidates.size(), kNoIndex);
    const double all_candidates = std::max<double>(1.0, static_cast<double>(candidates.size()));
    for (std::size_t o = 0; o < count; ++o) {
        const double weight = ground.weights[o] / all_candidates;
        result.coverage += weight * double{covered[o]};
        for (std::size_t level = 0; level < kCoveredOverlaps.size(); ++level) {
            if (double{covered[o]} >= kCoveredOverlaps[level]) result.covered[level] += weight;
        }
        if (coverer[o] == kNoIndex) continue;
        const auto at = std::lower_bound(result.chosen.begin(), result.chosen.end(), coverer[o]);
        result.nearest[ground.candidates[o]] =
            static_cast<std::uint32_t>(at - result.chosen.begin());
    }
    return result;
}

}  // namespace ostraka
