// SPDX-License-Identifier: Apache-2.0
// Floor: a product of two rows takes 22 multiply-adds of 16 values with AVX2, 11 of 32 with VNNI,
// and machines start two in each cycle. Tiles of four queries by several rows fetch each vector
// once for all of them: without tiles, fetching takes four times as long.
#include "ostraka/library/row_table.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#if defined(__GNUC__) && defined(__x86_64__)
#define OSTRAKA_X86_KERNELS 1
#include <immintrin.h>
#endif

namespace ostraka {
namespace {

constexpr std::size_t kTileQueries = 4;
static_assert(kQueryBlock % kTileQueries == 0);
static_assert(kShotLength % 32 == 0);

std::int32_t product(const std::uint8_t* a, const std::uint8_t* b) {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < kShotLength; ++i) sum += std::int32_t{a[i]} * std::int32_t{b[i]};
    return sum;
}

// What a kernel searches, and what it finds: |row - query|^2 less |query|^2, which is the same for
// all rows.
struct Search {
    const std::uint8_t* queries = nullptr;  // kQueryBlock of them
    const std::uint8_t* rows = nullptr;
    const std::int32_t* squares = nullptr;  // of rows
    const std::int32_t* sums = nullptr;     // of rows
    std::size_t count = 0;                  // of rows
    std::array<std::int32_t, kQueryBlock> best{};
    std::array<std::uint32_t, kQueryBlock> best_row{};
};

using Products = std::array<std::int32_t, kQueryBlock>;  // of each query with one row

__attribute__((always_inline)) inline void offer(std::size_t row, std::int32_t square,
                                                 const Products& products, Search& search) {
    for (std::size_t q = 0; q < kQueryBlock; ++q) {
        const std::int32_t distance = square - 2 * products[q];
        const bool nearer = distance < search.best[q];
        search.best[q] = nearer ? distance : search.best[q];
        search.best_row[q] = nearer ? static_cast<std::uint32_t>(row) : search.best_row[q];
    }
}

void search_plainly(Search& search) {
    Products products;
    for (std::size_t row = 0; row < search.count; ++row) {
        for (std::size_t q = 0; q < kQueryBlock; ++q) {
            products[q] =
                product(search.queries + q * kShotLength, search.rows + row * kShotLength);
        }
        offer(row, search.squares[row], products, search);
    }
}

#ifdef OSTRAKA_X86_KERNELS

#define OSTRAKA_AVX2 __attribute__((target("avx2")))
#define OSTRAKA_VNNI __attribute__((target("avx2,avx512vl,avx512vnni")))

// A row's products with each query of a tile, in lanes that are yet to be added up.
struct Lanes {
    __m256i q0;
    __m256i q1;
    __m256i q2;
    __m256i q3;
};

OSTRAKA_AVX2 inline Lanes no_lanes() {
    const __m256i zero = _mm256_setzero_si256();
    return {zero, zero, zero, zero};
}

OSTRAKA_AVX2 inline void store_totals(const Lanes& lanes, std::int32_t* to) {
    const __m256i pairs = _mm256_hadd_epi32(_mm256_hadd_epi32(lanes.q0, lanes.q1),
                                            _mm256_hadd_epi32(lanes.q2, lanes.q3));
    const __m128i totals =
        _mm_add_epi32(_mm256_castsi256_si128(pairs), _mm256_extracti128_si256(pairs, 1));
    std::memcpy(to, &totals, sizeof(totals));
}

OSTRAKA_AVX2 inline __m256i load32(const void* from) {
    __m256i value;
    std::memcpy(&value, from, sizeof(value));
    return value;
}
OSTRAKA_AVX2 inline __m256i load16_widened(const std::uint8_t* from) {
    __m128i value;
    std::memcpy(&value, from, sizeof(value));
    return _mm256_cvtepu8_epi16(value);
}

// Queries widened to 16 bits once; rows whenever they are fetched, for all queries of a tile.
using WideQueries = std::array<std::int16_t, kQueryBlock * kShotLength>;

OSTRAKA_AVX2 inline void add_wide(Lanes& lanes, const std::uint8_t* row,
                                  const std::int16_t* queries) {
    const __m256i values = load16_widened(row);
    const __m256i t0 = _mm256_madd_epi16(values, load32(queries));
    const __m256i t1 = _mm256_madd_epi16(values, load32(queries + kShotLength));
    const __m256i t2 = _mm256_madd_epi16(values, load32(queries + 2 * kShotLength));
    const __m256i t3 = _mm256_madd_epi16(values, load32(queries + 3 * kShotLength));
    lanes.q0 = _mm256_add_epi32(lanes.q0, t0);
    lanes.q1 = _mm256_add_epi32(lanes.q1, t1);
    lanes.q2 = _mm256_add_epi32(lanes.q2, t2);
    lanes.q3 = _mm256_add_epi32(lanes.q3, t3);
}

OSTRAKA_AVX2 void search_by_avx2(Search& search) {
    constexpr std::size_t kTileRows = 2;
    WideQueries wide;
    std::copy_n(search.queries, wide.size(), wide.begin());
    std::array<Products, kTileRows> products;
    for (std::size_t row = 0; row < search.count; row += kTileRows) {
        const std::uint8_t* first = search.rows + row * kShotLength;
        // The last row is its own neighbor where there is no other.
        const bool both = row + 1 < search.count;
        const std::uint8_t* second = both ? first + kShotLength : first;
        for (std::size_t q = 0; q < kQueryBlock; q += kTileQueries) {
            const std::int16_t* queries = wide.data() + q * kShotLength;
            Lanes a = no_lanes();
            Lanes b = no_lanes();
            for (std::size_t i = 0; i < kShotLength; i += 16) {
                add_wide(a, first + i, queries + i);
                add_wide(b, second + i, queries + i);
            }
            store_totals(a, products[0].data() + q);
            store_totals(b, products[1].data() + q);
        }
        offer(row, search.squares[row], products[0], search);
        if (both) offer(row + 1, search.squares[row + 1], products[1], search);
    }
}

OSTRAKA_VNNI inline void add_bytes(Lanes& lanes, const std::uint8_t* row,
                                   const std::uint8_t* queries) {
    const __m256i values = load32(row);
    lanes.q0 = _mm256_dpbusd_epi32(lanes.q0, values, load32(queries));
    lanes.q1 = _mm256_dpbusd_epi32(lanes.q1, values, load32(queries + kShotLength));
    lanes.q2 = _mm256_dpbusd_epi32(lanes.q2, values, load32(queries + 2 * kShotLength));
    lanes.q3 = _mm256_dpbusd_epi32(lanes.q3, values, load32(queries + 3 * kShotLength));
}

// The instruction multiplies unsigned by signed bytes: row . query = row . (query - 128) + 128
// times the row's sum.
OSTRAKA_VNNI void search_by_vnni(Search& search) {
    constexpr std::size_t kTileRows = 4;
    constexpr std::uint8_t kMiddle = 128;
    std::array<std::uint8_t, kQueryBlock * kShotLength> queries;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        queries[i] = static_cast<std::uint8_t>(search.queries[i] ^ kMiddle);
    }
    std::array<Products, kTileRows> products;
    for (std::size_t row = 0; row < search.count; row += kTileRows) {
        const std::size_t rows = std::min(kTileRows, search.count - row);
        // Rows that aren't there are the last one again.
        const auto at = [&](std::size_t r) {
            return search.rows + (row + std::min(r, rows - 1)) * kShotLength;
        };
        const std::array<const std::uint8_t*, kTileRows> tile = {at(0), at(1), at(2), at(3)};
        for (std::size_t q = 0; q < kQueryBlock; q += kTileQueries) {
            const std::uint8_t* signed_bytes = queries.data() + q * kShotLength;
            Lanes a = no_lanes();
            Lanes b = no_lanes();
            Lanes c = no_lanes();
            Lanes d = no_lanes();
            for (std::size_t i = 0; i < kShotLength; i += 32) {
                add_bytes(a, tile[0] + i, signed_bytes + i);
                add_bytes(b, tile[1] + i, signed_bytes + i);
                add_bytes(c, tile[2] + i, signed_bytes + i);
                add_bytes(d, tile[3] + i, signed_bytes + i);
            }
            store_totals(a, products[0].data() + q);
            store_totals(b, products[1].data() + q);
            store_totals(c, products[2].data() + q);
            store_totals(d, products[3].data() + q);
        }
        for (std::size_t r = 0; r < rows; ++r) {
            const std::int32_t shifted =
                search.squares[row + r] - 2 * kMiddle * search.sums[row + r];
            offer(row + r, shifted, products[r], search);
        }
    }
}

#endif

void run(RowKernel kernel, Search& search) {
    switch (kernel) {
        case RowKernel::plain:
            return search_plainly(search);
#ifdef OSTRAKA_X86_KERNELS
        case RowKernel::avx2:
            return search_by_avx2(search);
        case RowKernel::vnni:
            return search_by_vnni(search);
#else
        default:
            return search_plainly(search);
#endif
    }
}

}  // namespace

bool supported(RowKernel kernel) {
#ifdef OSTRAKA_X86_KERNELS
    const bool avx2 = __builtin_cpu_supports("avx2") != 0;
    if (kernel == RowKernel::avx2) return avx2;
    if (kernel == RowKernel::vnni) {
        return avx2 && __builtin_cpu_supports("avx512vnni") != 0 &&
               __builtin_cpu_supports("avx512vl") != 0;
    }
#endif
    return kernel == RowKernel::plain;
}

RowKernel fastest_row_kernel() {
    static const RowKernel fastest = [] {
        for (const RowKernel kernel : {RowKernel::vnni, RowKernel::avx2}) {
            if (supported(kernel)) return kernel;
        }
        return RowKernel::plain;
    }();
    return fastest;
}

RowTable::RowTable(std::span<const std::uint8_t> rows) : rows_(rows) {
    for (std::size_t i = 0; i + kShotLength <= rows.size(); i += kShotLength) {
        const std::span<const std::uint8_t> row = rows.subspan(i, kShotLength);
        squares_.push_back(product(row.data(), row.data()));
        std::int32_t sum = 0;
        for (const std::uint8_t value : row) sum += value;
        sums_.push_back(sum);
    }
}

void RowTable::nearest(std::span<const std::uint8_t> queries, NearestRow* nearest,
                       RowKernel kernel) const {
    std::array<std::uint8_t, kQueryBlock * kShotLength> block{};
    std::copy(queries.begin(), queries.end(), block.begin());
    Search search{block.data(), rows_.data(), squares_.data(), sums_.data(), size()};
    search.best.fill(std::numeric_limits<std::int32_t>::max());
    run(kernel, search);
    for (std::size_t q = 0; q * kShotLength < queries.size(); ++q) {
        const std::uint8_t* query = block.data() + q * kShotLength;
        nearest[q] = {search.best_row[q], search.best[q] + product(query, query)};
    }
}

}  // namespace ostraka
