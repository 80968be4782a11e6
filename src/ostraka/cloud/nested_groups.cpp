// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/clusters.hpp"
#include "ostraka/cloud/disjoint_sets.hpp"

namespace ostraka {
namespace {

// The root of the largest set among the points of at most this level; of equals, the set with the
// smallest index, which is its root.
std::uint32_t largest_root(DisjointSets& sets, std::span<const std::uint8_t> level,
                           std::size_t last, std::vector<std::uint32_t>& sizes) {
    sizes.assign(level.size(), 0);
    for (std::uint32_t i = 0; i < level.size(); ++i) {
        if (level[i] <= last) ++sizes[sets.find(i)];
    }
    return static_cast<std::uint32_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
}

}  // namespace

std::vector<std::vector<std::uint32_t>> largest_groups(const ProximityGraph& graph,
                                                       std::span<const std::uint8_t> level,
                                                       std::size_t levels) {
    std::vector<std::vector<std::uint32_t>> groups(levels);
    if (level.empty()) return groups;
    std::vector<std::vector<std::uint32_t>> at_level(levels);
    for (std::uint32_t i = 0; i < level.size(); ++i) {
        if (level[i] < levels) at_level[level[i]].push_back(i);
    }
    DisjointSets sets(level.size());
    std::vector<std::uint32_t> sizes;
    for (std::size_t l = 0; l < levels; ++l) {
        for (const std::uint32_t i : at_level[l]) {
            for (std::uint32_t n = graph.starts[i]; n < graph.starts[i + 1]; ++n) {
                const std::uint32_t other = graph.neighbors[n];
                // A pair within a level is met from both sides.
                if (level[other] < l || (level[other] == l && other < i)) sets.unite(i, other);
            }
        }
        const std::uint32_t root = largest_root(sets, level, l, sizes);
        groups[l].reserve(sizes[root]);
        for (std::uint32_t i = 0; i < level.size(); ++i) {
            if (level[i] <= l && sets.find(i) == root) groups[l].push_back(i);
        }
    }
    return groups;
}

}  // namespace ostraka
