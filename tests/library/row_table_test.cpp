// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/row_table.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

constexpr std::array kKernels = {RowKernel::plain, RowKernel::avx2, RowKernel::vnni};

std::vector<std::uint8_t> random_rows(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<std::uint8_t> rows(count * kShotLength);
    // All values occur, the ends often: sums must not saturate.
    for (std::uint8_t& value : rows) {
        const auto drawn = random.below(512);
        value = static_cast<std::uint8_t>(drawn < 256 ? drawn : 255 * (drawn % 2));
    }
    return rows;
}

std::int32_t squared_distance(const std::uint8_t* a, const std::uint8_t* b) {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < kShotLength; ++i) {
        const std::int32_t difference = std::int32_t{a[i]} - std::int32_t{b[i]};
        sum += difference * difference;
    }
    return sum;
}

NearestRow by_brute_force(std::span<const std::uint8_t> rows, const std::uint8_t* query) {
    NearestRow best{0, std::numeric_limits<std::int32_t>::max()};
    for (std::uint32_t r = 0; r < rows.size() / kShotLength; ++r) {
        const std::int32_t distance = squared_distance(rows.data() + r * kShotLength, query);
        if (distance < best.distance) best = {r, distance};
    }
    return best;
}

TEST(RowTable, EveryKernelAgreesWithBruteForce) {
    for (const RowKernel kernel : kKernels) {
        if (!supported(kernel)) continue;  // plain always is
        for (const std::size_t count : {1U, 2U, 3U, 4U, 5U, 7U, 30U}) {
            const std::vector<std::uint8_t> rows = random_rows(count, count);
            const RowTable table(rows);
            ASSERT_EQ(table.size(), count);
            for (const std::size_t queried : {std::size_t{1}, std::size_t{5}, kQueryBlock}) {
                const std::vector<std::uint8_t> queries = random_rows(queried, 100 + queried);
                std::array<NearestRow, kQueryBlock> nearest;
                table.nearest(queries, nearest.data(), kernel);
                for (std::size_t q = 0; q < queried; ++q) {
                    const NearestRow best = by_brute_force(rows, queries.data() + q * kShotLength);
                    EXPECT_EQ(nearest[q].row, best.row);
                    EXPECT_EQ(nearest[q].distance, best.distance);
                }
            }
        }
    }
}

TEST(RowTable, OfEquallyNearRowsTheFirstIsFound) {
    std::vector<std::uint8_t> rows = random_rows(6, 1);
    // Rows 2 and 5 are one and the same.
    std::copy_n(rows.begin() + 2 * kShotLength, kShotLength, rows.begin() + 5 * kShotLength);
    const RowTable table(rows);
    for (const RowKernel kernel : kKernels) {
        if (!supported(kernel)) continue;
        NearestRow nearest;
        table.nearest(std::span(rows).last(kShotLength), &nearest, kernel);
        EXPECT_EQ(nearest.row, 2U);
        EXPECT_EQ(nearest.distance, 0);
    }
}

TEST(RowTable, TheFastestKernelIsSupported) {
    EXPECT_TRUE(supported(RowKernel::plain));
    EXPECT_TRUE(supported(fastest_row_kernel()));
}

}  // namespace
}  // namespace ostraka
