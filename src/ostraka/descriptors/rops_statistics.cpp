// SPDX-License-Identifier: Apache-2.0
// Guo et al. Rotational Projection Statistics for 3D Local Surface Description and Object
// Recognition. IJCV 105(1), 2013, section 3.2. The three 5 x 5 distribution matrices of a rotation
// are the marginals of one 5 x 5 x 5 histogram, so every point is counted once a rotation:
// 9 scattered additions and 9 x 30 operations, vectorized by eight, are a floor of 25 cycles a
// point; the statistics add a fixed 27 x 60 cycles a keypoint. Measured: about twice that.
#include "ostraka/descriptors/rops_statistics.hpp"

#include <array>
#include <limits>
#include <utility>

#include "ostraka/base/vector_clones.hpp"
#include "ostraka/descriptors/fast_math.hpp"

namespace ostraka {
namespace {

constexpr int kBins = 5;
constexpr int kRow = 8;  // cells along z, of which five are used, so that a row is a vector
constexpr int kSlab = kRow * kBins;
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

struct Turned {
    Range u, v;
};

// (u, v) = rotation of (a, b), counter-clockwise. @return their ranges.
OSTRAKA_VECTOR_CLONES
Turned rotate(const float* a, const float* b, std::size_t count, float cosine, float sine, float* u,
              float* v) {
    Float8 low_u = Float8{} + std::numeric_limits<float>::max();
    Float8 low_v = low_u;
    Float8 high_u = -low_u;
    Float8 high_v = -low_u;
    for (std::size_t i = 0; i < count; i += kVectorLanes) {
        Float8 x;
        Float8 y;
        load8(a + i, x);
        load8(b + i, y);
        const Float8 p = cosine * x - sine * y;
        const Float8 q = sine * x + cosine * y;
        std::memcpy(u + i, &p, sizeof(p));
        std::memcpy(v + i, &q, sizeof(q));
        low_u = p < low_u ? p : low_u;
        low_v = q < low_v ? q : low_v;
        high_u = p > high_u ? p : high_u;
        high_v = q > high_v ? q : high_v;
    }
    Turned turned{{low_u[0], high_u[0]}, {low_v[0], high_v[0]}};
    for (std::size_t lane = 1; lane < kVectorLanes; ++lane) {
        turned.u.low = std::min<float>(turned.u.low, low_u[lane]);
        turned.v.low = std::min<float>(turned.v.low, low_v[lane]);
        turned.u.high = std::max<float>(turned.u.high, high_u[lane]);
        turned.v.high = std::max<float>(turned.v.high, high_v[lane]);
    }
    return turned;
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
                std::uint16_t* cell) {
    const float sx = bins_per_length(x.range);
    const float sy = bins_per_length(y.range);
    const float sz = bins_per_length(z.range);
    const float lx = x.range.low;
    const float ly = y.range.low;
    const float lz = z.range.low;
    const float* vx = x.values;
    const float* vy = y.values;
    const float* vz = z.values;
    for (std::size_t i = 0; i < count; ++i) {
        cell[i] = static_cast<std::uint16_t>(bin_of(vx[i], lx, sx) * kSlab +
                                             bin_of(vy[i], ly, sy) * kRow + bin_of(vz[i], lz, sz));
    }
}

// A distribution matrix; the last three columns stay empty.
using Matrix = std::array<Word8, kBins>;

// Projections onto the planes xy, xz and yz.
OSTRAKA_VECTOR_CLONES
void project(const std::uint16_t* cell, std::size_t count, Matrix (&planes)[3]) {
    alignas(32) std::uint32_t copies[kCopies][kBins * kSlab] = {};
    std::size_t i = 0;
    for (; i + kCopies <= count; i += kCopies) {
        for (std::size_t k = 0; k < kCopies; ++k) ++copies[k][cell[i + k]];
    }
    for (; i < count; ++i) ++copies[0][cell[i]];
    for (Matrix& plane : planes) plane.fill(Word8{});
    for (std::size_t x = 0; x < kBins; ++x) {
        for (std::size_t y = 0; y < kBins; ++y) {
            Word8 sum = {};
            for (const auto& copy : copies) {
                Word8 part;
                load8(copy + x * kSlab + y * kRow, part);
                sum += part;
            }
            planes[0][x][y] = sum[0] + sum[1] + sum[2] + sum[3] + sum[4];
            planes[1][x] += sum;
            planes[2][y] += sum;
        }
    }
}

// n * log(n), from a table for common n.
constexpr std::uint32_t kTable = 1024;
const std::array<double, kTable>& n_log_n_table() {
    static const auto table = [] {
        std::array<double, kTable> values{};
        for (std::uint32_t n = 1; n < kTable; ++n) values[n] = n * fast_log(n);
        return values;
    }();
    return table;
}

// Sum of n * log(n) over the matrix.
double entropy_sum(const Matrix& matrix, const std::array<double, kTable>& table) {
    std::array<double, kBins> sums{};
    for (const Word8& row : matrix) {
        for (std::size_t j = 0; j < kBins; ++j) {
            const std::uint32_t n = row[j];
            sums[j] += n < kTable ? table[n] : n * fast_log(n);
        }
    }
    return (sums[0] + sums[1]) + (sums[2] + sums[3]) + sums[4];
}

// Sums of i^a j^b n_ij, exact.
struct RawMoments {
    double m10, m01, m11, m20, m02, m21, m12, m22;
};

OSTRAKA_VECTOR_CLONES
void raw_moments(const Matrix& matrix, RawMoments& m) {
    const Word8 once = matrix[1] + 2 * matrix[2] + 3 * matrix[3] + 4 * matrix[4];
    const Word8 twice = matrix[1] + 4 * matrix[2] + 9 * matrix[3] + 16 * matrix[4];
    const Word8 all = matrix[0] + matrix[1] + matrix[2] + matrix[3] + matrix[4];
    const auto at = [](const Word8& s, std::size_t k) { return static_cast<double>(s[k]); };
    const auto plain = [&](const Word8& s) {
        return at(s, 0) + at(s, 1) + at(s, 2) + at(s, 3) + at(s, 4);
    };
    const auto linear = [&](const Word8& s) {
        return at(s, 1) + 2.0 * at(s, 2) + 3.0 * at(s, 3) + 4.0 * at(s, 4);
    };
    const auto square = [&](const Word8& s) {
        return at(s, 1) + 4.0 * at(s, 2) + 9.0 * at(s, 3) + 16.0 * at(s, 4);
    };
    m = {plain(once), linear(all),   linear(once), plain(twice),
         square(all), linear(twice), square(once), square(twice)};
}

// Central moments 11, 21, 12, 22 and the entropy of a distribution. The central moments come from
// the raw ones, which are sums of integers below 2^32 and so exact.
std::array<double, 5> statistics(const Matrix& matrix, std::size_t count,
                                 const std::array<double, kTable>& table) {
    const double share = 1.0 / static_cast<double>(count);
    RawMoments m;
    raw_moments(matrix, m);
    const double i = m.m10 * share;
    const double j = m.m01 * share;
    const double m11 = m.m11 * share;
    const double m20 = m.m20 * share;
    const double m02 = m.m02 * share;
    const double m21 = m.m21 * share;
    const double m12 = m.m12 * share;
    const double m22 = m.m22 * share;
    return {m11 - i * j, m21 - 2.0 * i * m11 - j * m20 + 2.0 * i * i * j,
            m12 - 2.0 * j * m11 - i * m02 + 2.0 * i * j * j,
            m22 - 2.0 * j * m21 - 2.0 * i * m12 + 4.0 * i * j * m11 + j * j * m20 + i * i * m02 -
                3.0 * i * i * j * j,
            fast_log(static_cast<double>(count)) - entropy_sum(matrix, table) * share};
}

}  // namespace

void rops_statistics(const Support& support, const Mat3f& R_local_cloud, RopsScratch& scratch,
                     std::span<float> row) {
    const std::size_t count = support.count;
    std::fill(row.begin(), row.end(), 0.0F);
    if (count == 0) return;
    for (auto* column : {&scratch.x, &scratch.y, &scratch.z, &scratch.u, &scratch.v}) {
        if (column->size() < count + kVectorLanes) column->resize(count + kVectorLanes);
    }
    if (scratch.cell.size() < count) scratch.cell.resize(count);
    const Mat3f& R = R_local_cloud;
    into_frame(support,
               {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)},
               scratch.x.data(), scratch.y.data(), scratch.z.data());
    // Repeated, the last point fills up the last vector.
    for (auto* column : {&scratch.x, &scratch.y, &scratch.z}) {
        std::fill_n(column->begin() + static_cast<std::ptrdiff_t>(count), kVectorLanes,
                    (*column)[count - 1]);
    }
    const std::array<double, kTable>& table = n_log_n_table();
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
            const Turned turned = rotate(fixed[a], fixed[b], count, cosine, sine, u, v);
            columns[a] = {u, turned.u};
            columns[b] = {v, turned.v};
            find_cells(columns[0], columns[1], columns[2], count, scratch.cell.data());
            Matrix planes[3];
            project(scratch.cell.data(), count, planes);
            for (const Matrix& plane : planes) {
                for (const double value : statistics(plane, count, table)) {
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
