// SPDX-License-Identifier: Apache-2.0
// How the observations that an entry stands for vary: the mean of their descriptor rows and the
// directions in which they differ most. A row is compared with the patch that these span, not with
// one point of it, so that a few dozen entries serve like the hundreds that they were chosen from.
// After: Simard, LeCun, Denker. Efficient Pattern Recognition Using a New Transformation Distance
// (tangent distance). NIPS 1993; Vincent, Bengio. K-Local Hyperplane and Convex Distance Nearest
// Neighbor Algorithms. NIPS 2001. Departs from both: directions are principal ones of the
// candidates that an entry covers, and the patch ends where they end.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/descriptors/metric.hpp"

namespace ostraka {

/// The spreads of one descriptor, of all entries in their order. In the space of comparable_row()
/// with the descriptor's best_metric().
struct Spread {
    std::vector<float> means;             ///< entries x length
    std::vector<std::int8_t> directions;  ///< entries x count x length, orthogonal
    std::vector<float> scales;            ///< entries x count: a direction times its scale reaches
                                          ///< from the mean to the patch's edge
    bool empty() const { return means.empty(); }
    /// Directions of each entry. @param length  of a row.
    std::size_t count(std::size_t length) const {
        return empty() ? 0 : scales.size() / (means.size() / length);
    }
    void append(const Spread& other);
    /// Of the entries [first, last). @param length  of a row.
    Spread part(std::size_t first, std::size_t last, std::size_t length) const;
};

/// Appends the spread of one entry.
/// @param rows    comparable rows of what it stands for, itself included, one after another.
/// @param length  of a row.
/// @param count   of directions; those beyond the number of rows are zero.
void append_spread(std::span<const float> rows, std::size_t length, std::size_t count,
                   Spread& spread);

/// Spreads made ready to be searched; they must outlive it.
class SpreadIndex {
  public:
    SpreadIndex() = default;
    SpreadIndex(const Spread& spread, std::size_t length);
    bool empty() const { return length_ == 0; }
    /// L2 distance from a comparable row to the nearest point of each entry's patch.
    std::vector<float> distances(std::span<const float> row) const;

  private:
    std::size_t length_ = 0;
    std::size_t count_ = 0;            // of directions
    const Spread* spread_ = nullptr;   // its directions stay bytes: less memory to walk through
    std::vector<float> mean_squares_;  // of each entry
    std::vector<float> squares_;       // entries x count: of the scaled directions
    std::vector<float> offsets_;       // entries x count: mean . scaled direction
};

}  // namespace ostraka
