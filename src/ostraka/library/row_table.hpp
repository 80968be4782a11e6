// SPDX-License-Identifier: Apache-2.0
// Many rows of bytes compared with many: a small matrix product. Distances are integers, so they
// are the same on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/descriptors/shot.hpp"

namespace ostraka {

/// A row and its squared distance from a query.
struct NearestRow {
    std::uint32_t row = 0;
    std::int32_t distance = 0;
};

/// Queries that are compared with a row while it is at hand: more at a time are no faster.
inline constexpr std::size_t kQueryBlock = 16;

/// How rows are multiplied. All find the same.
enum class RowKernel { plain, avx2, vnni };
/// Whether this machine can. @{
bool supported(RowKernel kernel);
RowKernel fastest_row_kernel();
/// @}

/// Rows of kShotLength bytes, ready to be searched.
class RowTable {
  public:
    RowTable() = default;
    /// @param rows  size() x kShotLength; must outlive the table.
    explicit RowTable(std::span<const std::uint8_t> rows);

    std::size_t size() const { return squares_.size(); }
    /// The nearest row of each query; of equally near ones the first.
    /// @param queries  1 to kQueryBlock rows of kShotLength. @param nearest  out: one for each.
    /// There is at least one row. The kernel is supported().
    void nearest(std::span<const std::uint8_t> queries, NearestRow* nearest,
                 RowKernel kernel = fastest_row_kernel()) const;

  private:
    std::span<const std::uint8_t> rows_;
    std::vector<std::int32_t> squares_;  // of each row, the sum of its values squared
    std::vector<std::int32_t> sums_;     // of each row's values
};

}  // namespace ostraka
