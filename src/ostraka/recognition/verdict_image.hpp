// SPDX-License-Identifier: Apache-2.0
// The verdicts on a placed model as an image: what is beside what.
#pragma once

#include <array>
#include <span>
#include <utility>

#include "ostraka/recognition/cell_check.hpp"

namespace ostraka {

/// By column u and row v of the range map.
class VerdictImage {
  public:
    static constexpr std::size_t kOutside = static_cast<std::size_t>(-1);

    /// @param window    cells of a rectangle of the range map, ascending
    /// (RangeMap::cells_around()).
    /// @param verdicts  one for each of them.
    VerdictImage(const RangeMap& ranges, std::span<const std::uint32_t> window,
                 std::span<const CellVerdict> verdicts)
        : width_(static_cast<int>(ranges.width())),
          height_(static_cast<int>(ranges.height())),
          low_u_(u(window.front())),
          low_v_(v(window.front())),
          columns_(u(window.back()) - low_u_ + 1),
          verdicts_(verdicts) {}

    /// Of the window, or kOutside.
    std::size_t index(int u, int v) const {
        const int column = u - low_u_;
        const int row = v - low_v_;
        if (column < 0 || row < 0 || column >= columns_) return kOutside;
        const auto i = static_cast<std::size_t>(row * columns_ + column);
        return i < verdicts_.size() ? i : kOutside;
    }
    CellVerdict at(int u, int v) const {
        const std::size_t i = index(u, v);
        return i == kOutside ? CellVerdict::outside : verdicts_[i];
    }
    /// Whether the visible part of the model has ended there.
    bool beyond(int u, int v) const {
        const CellVerdict verdict = at(u, v);
        return verdict == CellVerdict::outside || verdict == CellVerdict::hidden;
    }
    /// Whether the model's surface isn't where the scan's is.
    bool lacks(int u, int v) const {
        const CellVerdict verdict = at(u, v);
        return beyond(u, v) || verdict == CellVerdict::violation;
    }
    std::uint32_t cell(int u, int v) const {
        if (u < 0 || v < 0 || u >= width_ || v >= height_) return kNoIndex;
        return static_cast<std::uint32_t>(v * width_ + u);
    }
    int u(std::uint32_t cell) const { return static_cast<int>(cell) % width_; }
    int v(std::uint32_t cell) const { return static_cast<int>(cell) / width_; }

  private:
    int width_;
    int height_;
    int low_u_;
    int low_v_;
    int columns_;
    std::span<const CellVerdict> verdicts_;
};

/// Steps to the four cells beside one.
inline constexpr std::array<std::pair<int, int>, 4> kSides = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

}  // namespace ostraka
