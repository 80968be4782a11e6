// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/element_table.hpp"

namespace ostraka {
namespace {

using Block = ElementTable::Block;
constexpr std::size_t kLanes = ElementTable::kLanes;

__attribute__((always_inline)) inline void count_blocks(const ElementSet& set,
                                                        std::span<const Block> blocks,
                                                        int* common) {
    for (const Block& block : blocks) {
        std::array<std::uint64_t, kLanes> counts{};
        for (std::size_t w = 0; w < set.size(); ++w) {
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                const std::uint64_t both = set[w] & block[w * kLanes + lane];
                counts[lane] += static_cast<std::uint64_t>(__builtin_popcountll(both));
            }
        }
        for (const std::uint64_t count : counts) *common++ = static_cast<int>(count);
    }
}

void count_plainly(const ElementSet& set, std::span<const Block> blocks, int* common) {
    count_blocks(set, blocks, common);
}

// Compilers' own dispatch knows counting by vectors only as a feature of named processors.
#if defined(__GNUC__) && defined(__x86_64__)
__attribute__((target("popcnt"))) void count_by_words(const ElementSet& set,
                                                      std::span<const Block> blocks, int* common) {
    count_blocks(set, blocks, common);
}

__attribute__((target("avx512vpopcntdq,avx512vl"))) void count_by_vectors(
    const ElementSet& set, std::span<const Block> blocks, int* common) {
    count_blocks(set, blocks, common);
}

using Counter = decltype(&count_plainly);
Counter best_counter() {
    const bool vectors =
        __builtin_cpu_supports("avx512vpopcntdq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
    if (vectors) return count_by_vectors;
    return __builtin_cpu_supports("popcnt") != 0 ? count_by_words : count_plainly;
}
#else
auto best_counter() {
    return count_plainly;
}
#endif

}  // namespace

void ElementTable::add(const ElementSet& set) {
    const std::size_t lane = counts_.size() % kLanes;
    if (lane == 0) blocks_.emplace_back();
    for (std::size_t w = 0; w < set.size(); ++w) blocks_.back()[w * kLanes + lane] = set[w];
    counts_.push_back(count_elements(set));
}

void ElementTable::count_common(const ElementSet& set, std::vector<int>& common) const {
    common.resize(blocks_.size() * kLanes);
    static const auto count = best_counter();
    count(set, blocks_, common.data());
    common.resize(size());
}

}  // namespace ostraka
