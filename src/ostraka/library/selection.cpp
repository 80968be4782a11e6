// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/selection.hpp"

#include <algorithm>
#include <queue>

namespace ostraka {
namespace {

std::vector<std::uint32_t> drop_redundant(std::span<const ElementSet> candidates,
                                          double max_overlap) {
    std::vector<std::uint32_t> kept;
    std::vector<ElementSet> kept_sets;
    std::vector<float> with_kept;
    for (std::uint32_t i = 0; i < candidates.size(); ++i) {
        with_kept.resize(kept_sets.size());
        overlaps(candidates[i], kept_sets, with_kept);
        const bool redundant = std::any_of(with_kept.begin(), with_kept.end(), [&](float value) {
            return double{value} >= max_overlap;
        });
        if (redundant) continue;
        kept.push_back(i);
        kept_sets.push_back(candidates[i]);
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
    std::vector<float> candidate_overlaps(candidates.size());
    const auto gain_of = [&](std::uint32_t candidate) {
        overlaps(candidates[candidate], candidates, candidate_overlaps);
        double gain = 0.0;
        for (std::size_t o = 0; o < covered.size(); ++o) {
            gain += double{std::max(0.0F, candidate_overlaps[o] - covered[o])};
        }
        return gain;
    };
    std::priority_queue<Bound> queue;
    for (const std::uint32_t candidate : ground) queue.push({gain_of(candidate), candidate, 0});
    SelectionResult result;
    result.redundant = candidates.size() - ground.size();
    const auto budget = static_cast<std::size_t>(std::max(0, settings.budget));
    while (!queue.empty() && result.chosen.size() < budget) {
        const Bound top = queue.top();
        queue.pop();
        const double gain = gain_of(top.candidate);  // also fills candidate_overlaps
        if (top.round != result.chosen.size()) {
            queue.push({gain, top.candidate, result.chosen.size()});
            continue;
        }
        for (std::size_t o = 0; o < covered.size(); ++o) {
            covered[o] = std::max(covered[o], candidate_overlaps[o]);
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
