// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/byte_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/base/lane_sums.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/vector_clones.hpp"

#if OSTRAKA_HAS_AVX2_CLONES
#include <immintrin.h>
#endif

namespace ostraka {
namespace {

constexpr std::size_t kBlock = 4096;    // rows that a thread compares at a time
constexpr std::size_t kAhead = 4;       // rows that are fetched before they are needed
constexpr std::size_t kCacheLine = 64;  // bytes
constexpr std::size_t kBins = 1 << 16;  // of the histogram that ends are chosen by

std::int32_t sum_of_squares(const std::uint8_t* a, const std::uint8_t* b, std::size_t length) {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < length; ++i) {
        const std::int32_t difference = std::int32_t{a[i]} - std::int32_t{b[i]};
        sum += difference * difference;
    }
    return sum;
}

struct PlainKernel {
    static std::int32_t compare(const std::uint8_t* a, const std::uint8_t* b, std::size_t length) {
        return sum_of_squares(a, b, length);
    }
};

#if OSTRAKA_HAS_AVX2_CLONES
struct Avx2Kernel {
    // |a - b| of 32 bytes by saturated subtraction both ways, then squared and added in pairs.
    OSTRAKA_AVX2_CLONE static std::int32_t compare(const std::uint8_t* a, const std::uint8_t* b,
                                                   std::size_t length) {
        const __m256i zero = _mm256_setzero_si256();
        __m256i sums = zero;
        std::size_t i = 0;
        for (; i + 32 <= length; i += 32) {
            __m256i x;
            __m256i y;
            std::memcpy(&x, a + i, sizeof(x));
            std::memcpy(&y, b + i, sizeof(y));
            const __m256i d = _mm256_or_si256(_mm256_subs_epu8(x, y), _mm256_subs_epu8(y, x));
            const __m256i low = _mm256_unpacklo_epi8(d, zero);
            const __m256i high = _mm256_unpackhi_epi8(d, zero);
            sums = _mm256_add_epi32(sums, _mm256_madd_epi16(low, low));
            sums = _mm256_add_epi32(sums, _mm256_madd_epi16(high, high));
        }
        std::array<std::int32_t, 8> lanes;
        std::memcpy(lanes.data(), &sums, sizeof(sums));
        std::int32_t sum = sum_of_squares(a + i, b + i, length - i);
        for (const std::int32_t lane : lanes) sum += lane;
        return sum;
    }
};
#endif

void prefetch(const std::uint8_t* row, std::size_t length) {
    for (std::size_t i = 0; i < length; i += kCacheLine) __builtin_prefetch(row + i);
}

template <class Kernel>
__attribute__((always_inline)) inline void compare_listed(const std::uint8_t* rows,
                                                          std::size_t length,
                                                          const std::uint8_t* query,
                                                          const std::uint32_t* indices,
                                                          std::size_t count, std::int32_t* out) {
    const std::size_t ahead = std::min(kAhead, count);
    for (std::size_t i = 0; i < ahead; ++i) prefetch(rows + indices[i] * length, length);
    for (std::size_t i = 0; i < count; ++i) {
        if (i + ahead < count) prefetch(rows + indices[i + ahead] * length, length);
        out[i] = Kernel::compare(rows + indices[i] * length, query, length);
    }
}

template <class Kernel>
__attribute__((always_inline)) inline void compare_range(const std::uint8_t* rows,
                                                         std::size_t length,
                                                         const std::uint8_t* query,
                                                         std::size_t count, std::int32_t* out) {
    for (std::size_t i = 0; i < count; ++i) {
        out[i] = Kernel::compare(rows + i * length, query, length);
    }
}

OSTRAKA_DEFAULT_CLONE
void listed(const std::uint8_t* rows, std::size_t length, const std::uint8_t* query,
            const std::uint32_t* indices, std::size_t count, std::int32_t* out) {
    compare_listed<PlainKernel>(rows, length, query, indices, count, out);
}
OSTRAKA_DEFAULT_CLONE
void in_range(const std::uint8_t* rows, std::size_t length, const std::uint8_t* query,
              std::size_t count, std::int32_t* out) {
    compare_range<PlainKernel>(rows, length, query, count, out);
}
#if OSTRAKA_HAS_AVX2_CLONES
OSTRAKA_AVX2_CLONE
void listed(const std::uint8_t* rows, std::size_t length, const std::uint8_t* query,
            const std::uint32_t* indices, std::size_t count, std::int32_t* out) {
    compare_listed<Avx2Kernel>(rows, length, query, indices, count, out);
}
OSTRAKA_AVX2_CLONE
void in_range(const std::uint8_t* rows, std::size_t length, const std::uint8_t* query,
              std::size_t count, std::int32_t* out) {
    compare_range<Avx2Kernel>(rows, length, query, count, out);
}
#endif

// @param query  in steps of the scale, from its low end.
OSTRAKA_VECTOR_CLONES
float squared_steps(const std::uint8_t* row, const float* query, std::size_t length) {
    return sum_in_lanes<8>(query, row, length, [](float value, std::uint8_t byte) {
        const float difference = value - static_cast<float>(byte);
        return difference * difference;
    });
}

// The k nearest of the rows from `first` on, in order.
std::vector<RowMatch> nearest_in_block(const ByteRows& rows, const std::uint8_t* query,
                                       std::size_t first, std::size_t k) {
    const std::size_t count = std::min(kBlock, rows.size() - first);
    std::vector<std::int32_t> distances(count);
    in_range(rows.bytes.data() + first * rows.length, rows.length, query, count, distances.data());
    std::vector<RowMatch> matches(count);
    for (std::size_t i = 0; i < count; ++i) {
        matches[i] = {static_cast<std::uint32_t>(first + i), distances[i]};
    }
    const std::size_t kept = std::min(k, count);
    std::partial_sort(matches.begin(), matches.begin() + static_cast<std::ptrdiff_t>(kept),
                      matches.end(), nearer);
    matches.resize(kept);
    return matches;
}

// The value that a share of all lies below, from the histogram: never beyond the exact one.
float end_of_range(std::span<const float> values, float low, float high, double clipped,
                   bool upper) {
    const double scale = static_cast<double>(kBins) / (double{high} - double{low});
    std::vector<std::size_t> counts(kBins, 0);
    for (const float value : values) {
        const double from_end = upper ? double{high} - value : double{value} - low;
        ++counts[std::min(kBins - 1, static_cast<std::size_t>(from_end * scale))];
    }
    const auto allowed = static_cast<std::size_t>(clipped * static_cast<double>(values.size()));
    std::size_t beyond = 0;
    std::size_t bin = 0;
    while (bin < kBins && beyond + counts[bin] <= allowed) beyond += counts[bin++];
    const double from_end = static_cast<double>(bin) / scale;
    return static_cast<float>(upper ? high - from_end : low + from_end);
}

}  // namespace

void check(const ByteRows& rows) {
    if (rows.length == 0 || rows.length > kMaxByteRowLength) {
        throw InvalidInput(fmt::format("rows of {} bytes: 1 to {} can be compared", rows.length,
                                       kMaxByteRowLength));
    }
    if (rows.bytes.size() % rows.length != 0) {
        throw InvalidInput(fmt::format("{} bytes are no whole number of rows of {}",
                                       rows.bytes.size(), rows.length));
    }
    if (rows.size() >= kNoIndex) throw InvalidInput("more rows than an index can number");
}

ByteScale choose_scale(std::span<const float> values, double clipped) {
    if (!(clipped >= 0.0 && clipped <= 0.5)) {
        throw InvalidInput(fmt::format("a clipped share of {:g} is not in 0 to 0.5", clipped));
    }
    if (values.empty()) return {};
    float low = values[0];
    float high = values[0];
    for (const float value : values) {
        if (!std::isfinite(value)) throw InvalidInput("a value to be scaled is not finite");
        low = std::min(low, value);
        high = std::max(high, value);
    }
    float bottom = std::min(low, 0.0F);
    float top = std::max(high, bottom);
    if (low < high) {
        const float clipped_top = end_of_range(values, low, high, clipped, true);
        const float clipped_bottom =
            low >= 0.0F ? 0.0F : end_of_range(values, low, high, clipped, false);
        // Where all values but a few are equal, nothing is clipped.
        if (clipped_top > clipped_bottom) {
            top = clipped_top;
            bottom = clipped_bottom;
        }
    }
    const auto step = static_cast<float>((double{top} - double{bottom}) / 255.0);
    return {.low = bottom, .step = std::max(step, std::numeric_limits<float>::min())};
}

std::vector<std::uint8_t> quantize(std::span<const float> values, const ByteScale& scale) {
    std::vector<std::uint8_t> bytes(values.size());
    const float inverse = 1.0F / scale.step;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float byte = (values[i] - scale.low) * inverse + 0.5F;
        // Written so that a NaN fails the first comparison.
        bytes[i] = byte > 0.0F ? static_cast<std::uint8_t>(std::min(byte, 255.0F)) : 0;
    }
    return bytes;
}

void squared_distances(const ByteRows& rows, const std::uint8_t* query,
                       std::span<const std::uint32_t> indices, std::int32_t* distances) {
    listed(rows.bytes.data(), rows.length, query, indices.data(), indices.size(), distances);
}

std::int32_t squared_distance(const std::uint8_t* a, const std::uint8_t* b, std::size_t length) {
    std::int32_t distance = 0;
    in_range(a, length, b, 1, &distance);
    return distance;
}

std::vector<float> decoded_distances(const ByteRows& rows, const ByteScale& scale,
                                     std::span<const float> query,
                                     std::span<const RowMatch> matches) {
    if (query.size() != rows.length) {
        throw InvalidInput(fmt::format("a query of {} values can't be compared with rows of {}",
                                       query.size(), rows.length));
    }
    std::vector<float> steps(query.size());
    for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = (query[i] - scale.low) / scale.step;
    std::vector<float> distances(matches.size());
    for (std::size_t i = 0; i < matches.size(); ++i) {
        if (matches[i].row >= rows.size()) {
            throw InvalidInput(fmt::format("a match is row {} of {}", matches[i].row, rows.size()));
        }
        const float squared =
            squared_steps(rows.row(matches[i].row).data(), steps.data(), rows.length);
        distances[i] = scale.step * std::sqrt(squared);
    }
    return distances;
}

std::vector<RowMatch> exact_nearest(const ByteRows& rows, std::span<const std::uint8_t> query,
                                    std::size_t k) {
    check(rows);
    if (query.size() != rows.length) {
        throw InvalidInput(fmt::format("a query of {} bytes can't be compared with rows of {}",
                                       query.size(), rows.length));
    }
    std::vector<std::vector<RowMatch>> of_block((rows.size() + kBlock - 1) / kBlock);
    parallel_for(of_block.size(), [&](std::size_t block) {
        of_block[block] = nearest_in_block(rows, query.data(), block * kBlock, k);
    });
    std::vector<RowMatch> matches;
    for (const auto& block : of_block) matches.insert(matches.end(), block.begin(), block.end());
    std::sort(matches.begin(), matches.end(), nearer);
    matches.resize(std::min(k, matches.size()));
    return matches;
}

}  // namespace ostraka
