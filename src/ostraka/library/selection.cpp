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

// Candidates that differ, and how many candidates each of them stands for, itself included.
struct Ground {
    std::vector<std::uint32_t> candidates;
    std::vector<double> weights;
};

Ground drop_redundant(std::span<const ElementSet> candidates, double max_overlap) {
    Ground ground;
    OverlapRow kept_sets;
    std::vector<float> with_kept;
    for (std::uint32_t i = 0; i < candidates.size(); ++i) {
        kept_sets.with(candidates[i], with_kept);
        const auto most = std::max_element(with_kept.begin(), with_kept.end());
        if (most != with_kept.end() && double{*most} >= max_overlap) {
            ground.weights[static_cast<std::size_t>(most - with_kept.begin())] += 1.0;
            continue;
        }
        ground.candidates.push_back(i);
        ground.weights.push_back(1.0);
        kept_sets.add(candidates[i]);
    }
    return ground;
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
    const Ground ground = drop_redundant(candidates, settings.max_overlap);
    const std::size_t count = ground.candidates.size();
    std::vector<float> covered(count, 0.0F);
    OverlapRow all;
    for (const std::uint32_t i : ground.candidates) all.add(candidates[i]);
    const auto gain_of = [&](std::uint32_t candidate, std::vector<float>& row) {
        all.with(candidates[candidate], row);
        double gain = 0.0;
        for (std::size_t o = 0; o < covered.size(); ++o) {
            gain += ground.weights[o] * double{std::max(0.0F, row[o] - covered[o])};
        }
        return gain;
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
            covered[o] = std::max(covered[o], row[o]);
        }
        result.chosen.push_back(top.candidate);
    }
    std::sort(result.chosen.begin(), result.chosen.end());
    result.beyond_budget = count - result.chosen.size();
    const double all_candidates = std::max<double>(1.0, static_cast<double>(candidates.size()));
    for (std::size_t o = 0; o < count; ++o) {
        const double weight = ground.weights[o] / all_candidates;
        result.coverage += weight * double{covered[o]};
        for (std::size_t level = 0; level < kCoveredOverlaps.size(); ++level) {
            if (double{covered[o]} >= kCoveredOverlaps[level]) result.covered[level] += weight;
        }
    }
    return result;
}

}  // namespace ostraka
