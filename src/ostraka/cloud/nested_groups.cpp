// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/clusters.hpp"
#include "ostraka/cloud/disjoint_sets.hpp"

namespace ostraka {
namespace {

// The points of all levels in the order in which they join, and where each level begins.
struct Joining {
    std::vector<std::uint32_t> order;
    std::vector<std::uint32_t> place;  // of each point in `order`; kNoIndex: never joins
    std::vector<std::size_t> starts;   // levels + 1
};

Joining joining_order(std::span<const std::uint8_t> level, std::size_t levels) {
    Joining joining;
    joining.starts.assign(levels + 1, 0);
    for (const std::uint8_t l : level) {
        if (l < levels) ++joining.starts[l + std::size_t{1}];
    }
    for (std::size_t l = 0; l < levels; ++l) joining.starts[l + 1] += joining.starts[l];
    joining.order.resize(joining.starts.back());
    joining.place.assign(level.size(), kNoIndex);
    std::vector<std::size_t> next(joining.starts.begin(), joining.starts.end() - 1);
    for (std::uint32_t i = 0; i < level.size(); ++i) {
        if (level[i] >= levels) continue;
        joining.place[i] = static_cast<std::uint32_t>(next[level[i]]);
        joining.order[next[level[i]]++] = i;
    }
    return joining;
}

// The neighbors of point i that have joined before it. Whether one has is as good as random, so it
// is counted, not branched upon.
std::size_t earlier_neighbors(const ProximityGraph& graph, const Joining& joining, std::uint32_t i,
                              std::vector<std::uint32_t>& earlier) {
    const std::uint32_t first = graph.starts[i];
    const std::uint32_t end = graph.starts[i + 1];
    if (earlier.size() < end - first) earlier.resize(end - first);
    std::size_t count = 0;
    for (std::uint32_t n = first; n < end; ++n) {
        earlier[count] = graph.neighbors[n];
        count += joining.place[graph.neighbors[n]] < joining.place[i] ? 1 : 0;
    }
    return count;
}

// The root of the largest set among the points of at most this level; of equals, the set with the
// smallest index, which is its root. `sets` is flat.
std::uint32_t largest_root(const DisjointSets& sets, std::span<const std::uint32_t> joined,
                           std::vector<std::uint32_t>& sizes) {
    std::fill(sizes.begin(), sizes.end(), 0U);
    for (const std::uint32_t i : joined) ++sizes[sets.parent(i)];
    return static_cast<std::uint32_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
}

}  // namespace

std::vector<std::vector<std::uint32_t>> largest_groups(const ProximityGraph& graph,
                                                       std::span<const std::uint8_t> level,
                                                       std::size_t levels) {
    std::vector<std::vector<std::uint32_t>> groups(levels);
    if (level.empty()) return groups;
    const Joining joining = joining_order(level, levels);
    DisjointSets sets(level.size());
    std::vector<std::uint32_t> sizes(level.size());
    std::vector<std::uint32_t> earlier;
    for (std::size_t l = 0; l < levels; ++l) {
        for (std::size_t k = joining.starts[l]; k < joining.starts[l + 1]; ++k) {
            const std::uint32_t i = joining.order[k];
            const std::size_t count = earlier_neighbors(graph, joining, i, earlier);
            for (std::size_t n = 0; n < count; ++n) sets.unite(i, earlier[n]);
        }
        sets.flatten();
        const std::span joined(joining.order.data(), joining.starts[l + 1]);
        const std::uint32_t root = largest_root(sets, joined, sizes);
        groups[l].reserve(sizes[root]);
        for (std::uint32_t i = 0; i < level.size(); ++i) {
            if (sets.parent(i) == root && level[i] <= l) groups[l].push_back(i);
        }
    }
    return groups;
}

}  // namespace ostraka
