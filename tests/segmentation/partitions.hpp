// SPDX-License-Identifier: Apache-2.0
// Clouds in another order, and sets of indices that are the same but for that.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "ostraka/base/random.hpp"
#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka::test_scans {

inline std::vector<std::uint32_t> all_of(std::size_t count) {
    std::vector<std::uint32_t> indices(count);
    std::iota(indices.begin(), indices.end(), 0U);
    return indices;
}

inline std::vector<std::uint32_t> shuffled(std::size_t count, std::uint64_t seed) {
    std::vector<std::uint32_t> order = all_of(count);
    Random random(seed);
    for (auto i = static_cast<std::uint32_t>(count) - 1; i > 0; --i) {
        std::swap(order[i], order[random.below(i + 1)]);
    }
    return order;
}

/// Sets of indices into select(cloud, order) as sets of indices into the cloud, in ascending order.
inline std::vector<std::vector<std::uint32_t>> in_original(
    std::vector<std::vector<std::uint32_t>> sets, const std::vector<std::uint32_t>& order) {
    for (auto& set : sets) {
        for (std::uint32_t& i : set) i = order[i];
        std::sort(set.begin(), set.end());
    }
    std::sort(sets.begin(), sets.end());
    return sets;
}

}  // namespace ostraka::test_scans
