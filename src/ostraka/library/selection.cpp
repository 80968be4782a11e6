// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/selection.hpp"

#include <algorithm>
#include <queue>

#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

// Sets in one block, with their sizes: overlaps of one with all others.
class OverlapRow {
  public:
    void add(const ElementSet& set) {
        sets_.push_back(set);
        sizes_.push_back(count_elements(set));
    }
    std::size_t size() const { return sets_.size(); }
    /// Intersection over union of `set` with each, into `row` (replaced).
    void with(const ElementSet& set, std::vector<float>& row) const {
        thread_local std::vector<int> common;
        common.resize(sets_.size());
        row.resize(sets_.size());
        count_common(set, sets_, common);
        const int size = count_elements(set);
        for (std::size_t i = 0; i < row.size(); ++i) {
            const int either = size + sizes_[i] - common[i];
            row[i] = either > 0 ? static_cast<float>(common[i]) / static_cast<float>(either) : 0.0F;
        }
    }

  private:
    std::vector<ElementSet> sets_;
    std::vector<int> sizes_;
};

std::vector<std::uint32_t> drop_redundant(std::span<const ElementSet> candidates,
                                          double max_overlap) {
    std::vector<std::uint32_t> kept;
    OverlapRow kept_sets;
    std::vector<float> with_kept;
    for (std::uint32_t i = 0; i < candidates.size(); ++i) {
        kept_sets.with(candidates[i], with_kept);
        const bool redundant = std::any_of(with_kept.begin(), with_kept.end(), [&](float value) {
            return double{value} >= max_overlap;
        });
        if (redundant) continue;
        kept.push_back(i);
        kept_sets.add(candidates[i]);
    }
    return kept;
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

SelectionResult select_entries(std::span<const ElementSet> candidates,
                               const SelectionSettings& settings) {
    const std::vector<std::uint32_t> ground = drop_redundant(candidates, settings.max_overlap);
    std::vector<float> covered(candidates.size(), 0.0F);
    OverlapRow all;
    for (const ElementSet& candidate : candidates) all.add(candidate);
    const auto gain_of = [&](std::uint32_t candidate, std::vector<float>& row) {
        all.with(candidates[candidate], row);
        double gain = 0.0;
        for (std::size_t o = 0; o < covered.size(); ++o) {
            gain += double{std::max(0.0F, row[o] - covered[o])};
        }
        return gain;
    };
    std::vector<double> gains(ground.size());
    parallel_for(
        ground.size(),
        [&](std::size_t i) {
            thread_local std::vector<float> row;
            gains[i] = gain_of(ground[i], row);
        },
        32);
    std::priority_queue<Bound> queue;
    for (std::size_t i = 0; i < ground.size(); ++i) queue.push({gains[i], ground[i], 0});
    std::vector<float> row;
    SelectionResult result;
    result.redundant = candidates.size() - ground.size();
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
            covered[o] = std::max(covered[o], row[o]);
        }
        result.chosen.push_back(top.candidate);
    }
    std::sort(result.chosen.begin(), result.chosen.end());
    result.beyond_budget = ground.size() - result.chosen.size();
    for (const float value : covered) result.coverage += double{value};
    if (!candidates.empty()) result.coverage /= static_cast<double>(candidates.size());
    return result;
}

}  // namespace ostraka
