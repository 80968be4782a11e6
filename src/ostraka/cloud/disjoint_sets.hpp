// SPDX-License-Identifier: Apache-2.0
// Private to this module: which items are connected, while connections are added.
// Tarjan. Efficiency of a Good But Not Linear Set Union Algorithm. JACM 22(2), 1975 (with path
// halving, by index instead of rank).
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace ostraka {

class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count) : parent_(count) { clear(); }
    /// Every item is a set of its own again.
    void clear() { std::iota(parent_.begin(), parent_.end(), 0U); }
    std::uint32_t find(std::uint32_t item) {
        while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
        return item;
    }
    // The smaller root wins, so the result doesn't depend on the order of unions.
    void unite(std::uint32_t a, std::uint32_t b) {
        if (parent_[a] == parent_[b]) return;  // most pairs, once a group has formed
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }
    /// Makes every item's parent its root: parents have smaller numbers, so one ascending pass
    /// does.
    void flatten() {
        for (std::uint32_t& parent : parent_) parent = parent_[parent];
    }
    /// The root, after flatten().
    std::uint32_t parent(std::uint32_t item) const { return parent_[item]; }

  private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace ostraka
