// SPDX-License-Identifier: Apache-2.0
// Points sorted into cubic cells, for fixed-radius work: resampling, clusters, region growing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Non-empty cells of an axis-aligned grid, in ascending order of their keys. The points must be
/// finite. Deterministic: within a cell, points keep the order of their indices.
class CellGrid {
  public:
    /// @param cell  side of a cell, in the points' unit; positive.
    /// @throws InvalidInput if the points span more than 2^20 cells along an axis.
    CellGrid(std::span<const Vec3f> points, double cell);

    std::size_t cell_count() const { return keys_.size(); }
    /// Indices of the points in cell `c`.
    std::span<const std::uint32_t> members(std::size_t c) const {
        return {order_.data() + starts_[c], starts_[c + 1] - starts_[c]};
    }
    /// The cell that holds point `i`.
    std::uint32_t cell_of(std::uint32_t i) const { return cell_of_[i]; }
    /// Non-empty cells among the 27 around and including cell `c`, into `cells` (replaced).
    void neighborhood(std::size_t c, std::vector<std::uint32_t>& cells) const;

  private:
    std::vector<std::uint64_t> keys_;     // sorted; 21 bits an axis, x highest
    std::vector<std::uint32_t> starts_;   // cell_count() + 1 offsets into order_
    std::vector<std::uint32_t> order_;    // point indices, cell by cell
    std::vector<std::uint32_t> cell_of_;  // point -> cell
};

}  // namespace ostraka
