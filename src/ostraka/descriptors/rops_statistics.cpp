// SPDX-License-Identifier: Apache-2.0
// Guo et al. Rotational Projection Statistics for 3D Local Surface Description and Object
// Recognition. IJCV 105(1), 2013, section 3.2. The three 5 x 5 distribution matrices of a rotation
// are the marginals of one 5 x 5 x 5 histogram, so every point is counted once a rotation.
#include "ostraka/descriptors/rops_statistics.hpp"

#include <array>
#include <limits>
#include <utility>

#include "ostraka/descriptors/fast_math.hpp"
#include "ostraka/descriptors/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr int kBins = 5;
constexpr std::size_t kCells = kBins * kBins * kBins;
constexpr std::size_t kCopies = 4;  // of the histogram, so that neighbors don't wait for each other
// Cosine and sine of 22.5, 45 and 67.5 degrees.
constexpr std::array<std::pair<float, float>, 3> kTurns = {
    {{0.92387953F, 0.38268343F}, {0.70710678F, 0.70710678F}, {0.38268343F, 0.92387953F}}};

struct Range {
    float low = 0.0F;
    float high = 0.0F;
};

OSTRAKA_VECTOR_CLONES
Range range_of(const float* values, std::size_t count) {
    Float8 low = Float8{} + values[0];
    Float8 high = low;
    std::size_t i = 0;
    for (; i + kVectorLanes <= count; i += kVectorLanes) {
        Float8 value;
        load8(values + i, value);
        low = value < low ? value : low;
        high = value > high ? value : high;
    }
    Range range{low[0], high[0]};
    for (std::size_t lane = 1; lane < kVectorLanes; ++lane) {
        range.low = std::min<float>(range.low, low[lane]);
        range.high = std::max<float>(range.high, high[lane]);
    }
    for (; i < count; ++i) {
        range.low = std::min(range.low, values[i]);
        range.high = std::max(range.high, values[i]);
    }
    return range;
}

OSTRAKA_VECTOR_CLONES
void into_frame(const Support& s, const std::array<float, 9>& rows, float* x, float* y, float* z) {
    const float r[9] = {rows[0], rows[1], rows[2], rows[3], rows[4],
                        rows[5], rows[6], rows[7], rows[8]};
    const float* sx = s.x.data();
    const float* sy = s.y.data();
    const float* sz = s.z.data();
#pragma GCC ivdep
    for (std::size_t i = 0; i < s.count; ++i) {
        x[i] = r[0] * sx[i] + r[1] * sy[i] + r[2] * sz[i];
        y[i] = r[3] * sx[i] + r[4] * sy[i] + r[5] * sz[i];
        z[i] = r[6] * sx[i] + r[7] * sy[i] + r[8] * sz[i];
    }
}

// (u, v) = rotation of (a, b), counter-clockwise.
OSTRAKA_VECTOR_CLONES
void rotate(const float* a, const float* b, std::size_t count, float cosine, float sine, float* u,
            float* v) {
    for (std::size_t i = 0; i < count; ++i) {
        u[i] = cosine * a[i] - sine * b[i];
        v[i] = sine * a[i] + cosine * b[i];
    }
}

inline std::int32_t bin_of(float value, float low, float bins_per_length) {
    const auto bin = static_cast<std::int32_t>((value - low) * bins_per_length);
    return bin < kBins - 1 ? bin : kBins - 1;
}

float bins_per_length(const Range& range) {
    const float length = (range.high - range.low) / static_cast<float>(kBins);
    const float inverse = length > 0.0F ? 1.0F / length : 0.0F;
    return inverse <= std::numeric_limits<float>::max() ? inverse : 0.0F;
}

struct Column {
    const float* values;
    Range range;
};

OSTRAKA_VECTOR_CLONES
void find_cells(const Column& x, const Column& y, const Column& z, std::size_t count,
                std::int32_t* cell) {
    const float sx = bins_per_length(x.range);
    const float sy = bins_per_length(y.range);
    const float sz = bins_per_length(z.range);
    for (std::size_t i = 0; i < count; ++i) {
        cell[i] =
            (bin_of(x.values[i], x.range.low, sx) * kBins + bin_of(y.values[i], y.range.low, sy)) *
                kBins +
            bin_of(z.values[i], z.range.low, sz);
    }
}

using Matrix = std::array<std::uint32_t, kBins * kBins>;

// Projections onto the planes xy, xz and yz.
std::array<Matrix, 3> project(const std::vector<std::int32_t>& cell, std::size_t count) {
    std::array<std::array<std::uint32_t, kCells>, kCopies> copies{};
    for (std::size_t i = 0; i < count; ++i) {
        ++copies[i % kCopies][static_cast<std::size_t>(cell[i])];
    }
    std::array<Matrix, 3> planes{};
    for (std::size_t c = 0; c < kCells; ++c) {
        const std::uint32_t points = copies[0][c] + copies[1][c] + copies[2][c] + copies[3][c];
        const std::size_t x = c / (kBins * kBins);
        const std::size_t y = c / kBins % kBins;
        const std::size_t z = c % kBins;
        planes[0][x * kBins + y] += points;
        planes[1][x * kBins + z] += points;
        planes[2][y * kBins + z] += points;
    }
    return planes;
}

// n * log(n), from a table for common n.
double n_log_n(std::uint32_t n) {
    static const auto table = [] {
        std::array<double, 1024> values{};
        for (std::uint32_t i = 1; i < values.size(); ++i) values[i] = i * fast_log(i);
        return values;
    }();
    return n < table.size() ? table[n] : n * fast_log(n);
}

// Central moments 11, 21, 12, 22 and the entropy of a distribution.
std::array<double, 5> statistics(const Matrix& matrix, std::size_t count) {
    const double share = 1.0 / static_cast<double>(count);
    std::array<double, kBins> row_sums{};
    std::array<double, kBins> column_sums{};
    double entropy_sum = 0.0;
    for (std::size_t i = 0; i < kBins; ++i) {
        for (std::size_t j = 0; j < kBins; ++j) {
            const std::uint32_t n = matrix[i * kBins + j];
            row_sums[i] += n;
            column_sums[j] += n;
            entropy_sum += n_log_n(n);
        }
    }
    double mean_i = 0.0;
    double mean_j = 0.0;
    for (std::size_t i = 0; i < kBins; ++i) {
        mean_i += static_cast<double>(i) * row_sums[i] * share;
        mean_j += static_cast<double>(i) * column_sums[i] * share;
    }
    std::array<double, 5> result{};
    for (std::size_t i = 0; i < kBins; ++i) {
        double first = 0.0;
        double second = 0.0;
        for (std::size_t j = 0; j < kBins; ++j) {
            const double dj = static_cast<double>(j) - mean_j;
            first += matrix[i * kBins + j] * dj;
            second += matrix[i * kBins + j] * dj * dj;
        }
        const double di = static_cast<double>(i) - mean_i;
        result[0] += di * first;
        result[1] += di * di * first;
        result[2] += di * second;
        result[3] += di * di * second;
    }
    for (std::size_t k = 0; k < 4; ++k) result[k] *= share;
    result[4] = fast_log(static_cast<double>(count)) - entropy_sum * share;
    return result;
}

}  // namespace

void rops_statistics(const Support& support, const Mat3f& R_local_cloud, RopsScratch& scratch,
                     std::span<float> row) {
    const std::size_t count = support.count;
    std::fill(row.begin(), row.end(), 0.0F);
    if (count == 0) return;
    for (auto* column : {&scratch.x, &scratch.y, &scratch.z, &scratch.u, &scratch.v}) {
        if (column->size() < count) column->resize(count);
    }
    if (scratch.cell.size() < count) scratch.cell.resize(count);
    const Mat3f& R = R_local_cloud;
    into_frame(support,
               {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)},
               scratch.x.data(), scratch.y.data(), scratch.z.data());
    const std::array<const float*, 3> fixed = {scratch.x.data(), scratch.y.data(),
                                               scratch.z.data()};
    std::array<double, 135> values{};
    std::size_t out = 0;
    double norm = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        // A turn about the axis moves the two coordinates after it, cyclically.
        const std::size_t a = (axis + 1) % 3;
        const std::size_t b = (axis + 2) % 3;
        std::array<Column, 3> columns;
        columns[axis] = {fixed[axis], range_of(fixed[axis], count)};
        for (const auto& [cosine, sine] : kTurns) {
            float* u = scratch.u.data();
            float* v = scratch.v.data();
            rotate(fixed[a], fixed[b], count, cosine, sine, u, v);
            columns[a] = {u, range_of(u, count)};
            columns[b] = {v, range_of(v, count)};
            find_cells(columns[0], columns[1], columns[2], count, scratch.cell.data());
            for (const Matrix& plane : project(scratch.cell, count)) {
                for (const double value : statistics(plane, count)) {
                    values[out++] = value;
                    norm += std::abs(value);
                }
            }
        }
    }
    const double scale = norm > std::numeric_limits<float>::epsilon() ? 1.0 / norm : 1.0;
    for (std::size_t i = 0; i < values.size(); ++i) row[i] = static_cast<float>(values[i] * scale);
}

}  // namespace ostraka
