// SPDX-License-Identifier: Apache-2.0
// Exact sums don't depend on the order of their terms, so they are added four at a time.
#include "ostraka/descriptors/exact_sum.hpp"

#include <algorithm>
#include <array>

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kBlock = 128;  // points
constexpr std::size_t kLanes = 4;
using Float4 = float __attribute__((vector_size(16)));

const float* coordinates(std::span<const Vec3f> points) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    return points.empty() ? nullptr : points.front().data();
}

OSTRAKA_VECTOR_CLONES
float largest_magnitude(const float* values, std::size_t count) {
    Float8 lanes = {};
    std::size_t i = 0;
    for (; i + kVectorLanes <= count; i += kVectorLanes) {
        Float8 value;
        load8(values + i, value);
        const Float8 magnitude = value < 0.0F ? -value : value;
        lanes = magnitude > lanes ? magnitude : lanes;
    }
    float result = 0.0F;
    for (std::size_t lane = 0; lane < kVectorLanes; ++lane) {
        result = std::max<float>(result, lanes[lane]);
    }
    for (; i < count; ++i) result = std::max(result, std::abs(values[i]));
    return result;
}

// Four points are three vectors: x y z x, y z x y, z x y z.
OSTRAKA_VECTOR_CLONES
std::array<double, 3> sum_points(const float* xyz, std::size_t count, const TermRounder& rounded) {
    const double shift = rounded.shift();
    Double4 sums[3] = {};
    std::size_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
        for (std::size_t k = 0; k < 3; ++k) {
            Float4 values;
            std::memcpy(&values, xyz + 3 * i + kLanes * k, sizeof(values));
            sums[k] += (__builtin_convertvector(values, Double4) + shift) - shift;
        }
    }
    std::array<double, 3> total{};
    for (std::size_t k = 0; k < 3 * kLanes; ++k) total[k % 3] += sums[k / kLanes][k % kLanes];
    for (std::size_t k = 3 * i; k < 3 * count; ++k) total[k % 3] += rounded(double{xyz[k]});
    return total;
}

// Offsets of a block of points from the origin, filled up with 0 to whole vectors.
struct Offsets {
    std::array<double, kBlock + kLanes> x, y, z;
};

__attribute__((always_inline)) inline void fill(const float* xyz, std::size_t count,
                                                const std::array<double, 3>& origin, Offsets& o) {
    for (std::size_t i = 0; i < count; ++i) {
        o.x[i] = xyz[3 * i] - origin[0];
        o.y[i] = xyz[3 * i + 1] - origin[1];
        o.z[i] = xyz[3 * i + 2] - origin[2];
    }
    for (std::size_t i = count; i < count + kLanes; ++i) o.x[i] = o.y[i] = o.z[i] = 0.0;
}

OSTRAKA_VECTOR_CLONES
double largest_square(const float* xyz, std::size_t count, const std::array<double, 3>& origin) {
    Offsets offsets;
    Double4 lanes = {};
    for (std::size_t first = 0; first < count; first += kBlock) {
        const std::size_t points = count - first < kBlock ? count - first : kBlock;
        fill(xyz + 3 * first, points, origin, offsets);
        for (std::size_t i = 0; i < points; i += kLanes) {
            Double4 x;
            Double4 y;
            Double4 z;
            load4(offsets.x.data() + i, x);
            load4(offsets.y.data() + i, y);
            load4(offsets.z.data() + i, z);
            const Double4 square = x * x + y * y + z * z;
            lanes = square > lanes ? square : lanes;
        }
    }
    return std::max(std::max<double>(lanes[0], lanes[1]), std::max<double>(lanes[2], lanes[3]));
}

// Sums of xx, xy, xz, yy, yz, zz.
OSTRAKA_VECTOR_CLONES
std::array<double, 6> sum_products(const float* xyz, std::size_t count,
                                   const std::array<double, 3>& origin,
                                   const TermRounder& rounded) {
    const double shift = rounded.shift();
    Offsets offsets;
    Double4 sums[6] = {};
    for (std::size_t first = 0; first < count; first += kBlock) {
        const std::size_t points = count - first < kBlock ? count - first : kBlock;
        fill(xyz + 3 * first, points, origin, offsets);
        for (std::size_t i = 0; i < points; i += kLanes) {
            Double4 x;
            Double4 y;
            Double4 z;
            load4(offsets.x.data() + i, x);
            load4(offsets.y.data() + i, y);
            load4(offsets.z.data() + i, z);
            sums[0] += (x * x + shift) - shift;
            sums[1] += (x * y + shift) - shift;
            sums[2] += (x * z + shift) - shift;
            sums[3] += (y * y + shift) - shift;
            sums[4] += (y * z + shift) - shift;
            sums[5] += (z * z + shift) - shift;
        }
    }
    std::array<double, 6> total{};
    for (std::size_t k = 0; k < 6; ++k) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) total[k] += sums[k][lane];
    }
    return total;
}

}  // namespace

Vec3d exact_centroid(std::span<const Vec3f> points) {
    const float* xyz = coordinates(points);
    const TermRounder rounded(points.size(), largest_magnitude(xyz, 3 * points.size()));
    const auto [x, y, z] = sum_points(xyz, points.size(), rounded);
    return Vec3d(x, y, z) / static_cast<double>(points.size());
}

Mat3d exact_scatter(std::span<const Vec3f> points, const Vec3d& origin) {
    const double radius = largest_distance(points, origin);
    const TermRounder rounded(points.size(), radius * radius);
    const auto [xx, xy, xz, yy, yz, zz] = sum_products(
        coordinates(points), points.size(), {origin.x(), origin.y(), origin.z()}, rounded);
    Mat3d scatter;
    scatter << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return scatter;
}

double largest_distance(std::span<const Vec3f> points, const Vec3d& origin) {
    return std::sqrt(
        largest_square(coordinates(points), points.size(), {origin.x(), origin.y(), origin.z()}));
}

}  // namespace ostraka
