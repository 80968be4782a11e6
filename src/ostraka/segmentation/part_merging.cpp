// SPDX-License-Identifier: Apache-2.0
#include "ostraka/segmentation/part_merging.hpp"

#include <algorithm>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

#include "ostraka/base/types.hpp"

namespace ostraka {
namespace {

// Concave pairs across the border per point of a group, above which it is narrower than about 3.5
// sampling distances: with a reach of two, 5 pairs cross each sampling distance of a border. A
// square of 60 points, concave all around, has 2.7.
constexpr std::uint32_t kStrip = 3;

void add(Border& to, const Border& more) {
    to.convex += more.convex;
    to.concave += more.concave;
    to.singular += more.singular;
}

}  // namespace

PartMerging::PartMerging(std::vector<std::uint32_t> sizes)
    : sizes_(std::move(sizes)), parent_(sizes_.size()), borders_(sizes_.size()) {
    std::iota(parent_.begin(), parent_.end(), 0U);
}

void PartMerging::add_border(std::uint32_t a, std::uint32_t b, const Border& border) {
    add(borders_[a][b], border);
    add(borders_[b][a], border);
}

std::uint32_t PartMerging::group(std::uint32_t patch) {
    while (parent_[patch] != patch) patch = parent_[patch] = parent_[parent_[patch]];
    return patch;
}

void PartMerging::merge(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t kept = std::min(a, b);
    const std::uint32_t gone = std::max(a, b);
    parent_[gone] = kept;
    sizes_[kept] += sizes_[gone];
    borders_[kept].erase(gone);
    for (const auto& [other, border] : borders_[gone]) {
        if (other == kept) continue;
        add(borders_[kept][other], border);
        add(borders_[other][kept], border);
        borders_[other].erase(gone);
    }
    borders_[gone].clear();
}

std::uint32_t PartMerging::best_neighbor(std::uint32_t group) const {
    std::uint32_t best = kNoIndex;
    std::pair<std::uint32_t, std::uint32_t> longest{0, 0};
    for (const auto& [other, border] : borders_[group]) {
        const std::pair<std::uint32_t, std::uint32_t> length{border.convex, border.pairs()};
        if (best == kNoIndex || length > longest) {
            longest = length;
            best = other;
        }
    }
    return best;
}

bool PartMerging::is_part(std::uint32_t group, std::size_t min_points) const {
    std::uint32_t concave = 0;
    for (const auto& [other, border] : borders_[group]) concave += border.concave;
    return sizes_[group] >= min_points && concave <= kStrip * sizes_[group];
}

void PartMerging::absorb_small(std::size_t min_points) {
    using Item = std::pair<std::uint32_t, std::uint32_t>;  // size, group
    std::priority_queue<Item, std::vector<Item>, std::greater<>> small;
    for (std::uint32_t g = 0; g < sizes_.size(); ++g) {
        if (parent_[g] == g && !is_part(g, min_points)) small.emplace(sizes_[g], g);
    }
    while (!small.empty()) {
        const auto [size, g] = small.top();
        small.pop();
        if (parent_[g] != g || sizes_[g] != size) continue;  // has merged meanwhile
        const std::uint32_t other = best_neighbor(g);
        if (other == kNoIndex) continue;
        merge(g, other);
        const std::uint32_t merged = std::min(g, other);
        if (!is_part(merged, min_points)) small.emplace(sizes_[merged], merged);
    }
}

}  // namespace ostraka
