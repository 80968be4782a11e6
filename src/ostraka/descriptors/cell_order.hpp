// SPDX-License-Identifier: Apache-2.0
// Private to this module: points sorted into the cells of a dense grid, so that what lies around a
// position is a few runs of consecutive points, which vectorized loops sweep.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// The order of the points by cell; within a cell they keep the order of their indices. A few
/// points far away from the others cost speed, never memory or exactness: the outermost cells take
/// what lies beyond them, and cells grow until there are at most 16 a point.
class CellOrder {
  public:
    /// @param points  finite.
    /// @param cell  side of a cell, in the points' unit; positive.
    CellOrder(std::span<const Vec3f> points, float cell);

    /// Point indices, cell by cell.
    std::span<const std::uint32_t> order() const { return order_; }
    std::size_t cell_count() const { return starts_.size() - 1; }
    /// The points of a cell: order()[begin(c)] to before order()[begin(c + 1)].
    std::uint32_t begin(std::size_t cell) const { return starts_[cell]; }

    /// Calls run(first, end) for each non-empty run of positions in order(). Together they hold all
    /// points whose distance from `center`, computed in float, is at most `reach`, and others.
    template <class Run>
    void for_runs(const Vec3f& center, float reach, const Run& run) const {
        const float wide = reach * 1.000001F;
        for_runs(center - Vec3f::Constant(wide), center + Vec3f::Constant(wide), run);
    }

    /// The same for all points in a box.
    template <class Run>
    void for_runs(const Vec3f& low, const Vec3f& high, const Run& run) const {
        const std::size_t first_z = cell_along(low, 2);
        const std::size_t last_z = cell_along(high, 2);
        const std::size_t last_y = cell_along(high, 1);
        const std::size_t last_x = cell_along(high, 0);
        for (std::size_t x = cell_along(low, 0); x <= last_x; ++x) {
            for (std::size_t y = cell_along(low, 1); y <= last_y; ++y) {
                const std::size_t row = (x * cells_[1] + y) * cells_[2];
                const std::uint32_t first = starts_[row + first_z];
                const std::uint32_t end = starts_[row + last_z + 1];
                if (first < end) run(std::size_t{first}, std::size_t{end});
            }
        }
    }

  private:
    // Monotonic, also beyond the grid; 0 for NaN.
    std::size_t cell_along(const Vec3f& point, int axis) const {
        const auto a = static_cast<std::size_t>(axis);
        const float cell = (point[axis] - low_[axis]) * cells_per_length_;
        const float bounded = cell > 0.0F ? cell : 0.0F;
        return static_cast<std::size_t>(bounded < last_[a] ? bounded : last_[a]);
    }
    std::size_t cell_at(const Vec3f& point) const {
        return (cell_along(point, 0) * cells_[1] + cell_along(point, 1)) * cells_[2] +
               cell_along(point, 2);
    }

    Vec3f low_ = Vec3f::Zero();
    float cells_per_length_ = 0.0F;
    std::array<std::size_t, 3> cells_{1, 1, 1};
    std::array<float, 3> last_{};        // cells_ - 1
    std::vector<std::uint32_t> starts_;  // offsets into order_ for each cell, x slowest; one more
    std::vector<std::uint32_t> order_;
};

}  // namespace ostraka
