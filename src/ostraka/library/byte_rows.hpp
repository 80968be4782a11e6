// SPDX-License-Identifier: Apache-2.0
// Rows of 8-bit numbers, compared by squared L2. Distances are integers, so they and their order
// are the same on every machine and for any order of summation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Longest row: its squared length fits 31 bits.
inline constexpr std::size_t kMaxByteRowLength = 33'025;

/// Rows of equal length that lie elsewhere, row-major: descriptor rows by quantize(), or a model's
/// Keypoints::rows.
struct ByteRows {
    std::span<const std::uint8_t> bytes;  ///< size() x length
    std::size_t length = 0;               ///< bytes a row, 1 to kMaxByteRowLength

    std::size_t size() const { return length == 0 ? 0 : bytes.size() / length; }
    std::span<const std::uint8_t> row(std::size_t i) const {
        return bytes.subspan(i * length, length);
    }
};

/// @throws InvalidInput if the length is out of range, the bytes don't fill whole rows, or there
///         are kNoIndex rows or more.
void check(const ByteRows& rows);

/// What bytes mean: value = low + step * byte.
struct ByteScale {
    float low = 0.0F;   ///< value of byte 0
    float step = 1.0F;  ///< positive; a squared distance of bytes, times step squared, is one of
                        ///< values
};

/// The scale that spreads the values over the bytes. `low` is 0 where no value is negative.
/// @param values   any number, e.g. all comparable_row()s of a table.
/// @param clipped  share of all values that may lie beyond either end, 0 to 0.5: rare large values
///                 would make the steps of all others coarse.
/// @throws InvalidInput if a value is not finite or `clipped` is out of range.
ByteScale choose_scale(std::span<const float> values, double clipped = 1e-5);

/// Each value rounded to the nearest byte, clamped to 0 to 255.
/// @param values  as for choose_scale(); a NaN becomes 0.
std::vector<std::uint8_t> quantize(std::span<const float> values, const ByteScale& scale);

/// A row found, and how far it is.
struct RowMatch {
    std::uint32_t row = kNoIndex;  ///< index into the rows searched
    std::int32_t distance = 0;     ///< squared, between bytes

    friend bool operator==(const RowMatch&, const RowMatch&) = default;
};

/// Nearest first, ties by index: the order of all searches.
inline bool nearer(const RowMatch& a, const RowMatch& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.row < b.row;
}

/// Squared distances of a query from the rows numbered `indices`, which are fetched ahead.
/// @param query      rows.length bytes.
/// @param indices    below rows.size(); not checked.
/// @param distances  out: one for each index.
void squared_distances(const ByteRows& rows, const std::uint8_t* query,
                       std::span<const std::uint32_t> indices, std::int32_t* distances);

/// Squared distance of two rows of `length` bytes.
std::int32_t squared_distance(const std::uint8_t* a, const std::uint8_t* b, std::size_t length);

/// L2 distances, in the unit of values, of a query from rows as the scale decodes them. The query
/// is not rounded, which makes half of the error of comparing bytes: for a last look at what a
/// search found.
/// @param query    rows.length values, as comparable_row() gives them.
/// @param matches  of a search; their distances are not used.
/// @return one for each match, the same bits on every machine.
/// @throws InvalidInput if the query has another length or a match is no row's.
std::vector<float> decoded_distances(const ByteRows& rows, const ByteScale& scale,
                                     std::span<const float> query,
                                     std::span<const RowMatch> matches);

/// The k nearest of all rows by looking at each; nearest first, ties by index.
/// @param query  rows.length bytes.
/// @return min(k, rows.size()) matches; the same for any number of threads.
/// @throws InvalidInput if check() fails or the query has another length.
std::vector<RowMatch> exact_nearest(const ByteRows& rows, std::span<const std::uint8_t> query,
                                    std::size_t k);

}  // namespace ostraka
