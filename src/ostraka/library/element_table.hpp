// SPDX-License-Identifier: Apache-2.0
// Many sets of surface elements, laid out so that one more is compared with all of them at once.
#pragma once

#include <span>
#include <vector>

#include "ostraka/library/surface_elements.hpp"

namespace ostraka {

class ElementTable {
  public:
    static constexpr std::size_t kLanes = 8;
    /// Eight sets side by side, word by word.
    using Block = std::array<std::uint64_t, kLanes * std::tuple_size_v<ElementSet>>;

    void add(const ElementSet& set);
    std::size_t size() const { return counts_.size(); }
    /// Elements in each set.
    std::span<const int> counts() const { return counts_; }
    /// Elements that `set` shares with each, into `common` (replaced). Integers, so the same
    /// numbers whatever the machine's instructions are.
    void count_common(const ElementSet& set, std::vector<int>& common) const;

  private:
    std::vector<Block> blocks_;
    std::vector<int> counts_;
};

}  // namespace ostraka
