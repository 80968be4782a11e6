// SPDX-License-Identifier: Apache-2.0
// Private to this module: groups of patches that merge, and what is known of the borders between
// them.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace ostraka {

/// The border between two groups, in connected pairs of points.
struct Border {
    std::uint32_t convex = 0;
    std::uint32_t concave = 0;   ///< creases and steps
    std::uint32_t singular = 0;  ///< in corners: says nothing
    std::uint32_t pairs() const { return convex + concave + singular; }
};

class PartMerging {
  public:
    /// @param sizes  points of each patch; every patch is a group of its own.
    explicit PartMerging(std::vector<std::uint32_t> sizes);

    void add_border(std::uint32_t a, std::uint32_t b, const Border& border);
    /// The group of a patch: the smallest number of its patches.
    std::uint32_t group(std::uint32_t patch);
    /// Of two different groups that touch.
    const Border& border(std::uint32_t a, std::uint32_t b) const { return borders_[a].at(b); }
    void merge(std::uint32_t a, std::uint32_t b);
    /// Merges groups of less than `min_points`, smallest first, with the neighbor they have the
    /// longest convex border with; without any, the longest border.
    void absorb_small(std::size_t min_points);

    std::uint32_t size(std::uint32_t group) const { return sizes_[group]; }
    /// Neighbors of a group, ascending, with the borders to them.
    const std::map<std::uint32_t, Border>& borders(std::uint32_t group) const {
        return borders_[group];
    }

  private:
    bool is_part(std::uint32_t group, std::size_t min_points) const;
    std::uint32_t best_neighbor(std::uint32_t group) const;

    std::vector<std::uint32_t> sizes_;   // of groups
    std::vector<std::uint32_t> parent_;  // patch -> patch of the same group with a smaller number
    std::vector<std::map<std::uint32_t, Border>> borders_;
};

}  // namespace ostraka
