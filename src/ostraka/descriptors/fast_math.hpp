// SPDX-License-Identifier: Apache-2.0
// Private to this module: elementary functions without branches, tables or the C library, so that
// they vectorize and give the same bits on every machine.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace ostraka {

/// The angle of (x, y) in [-pi, pi], error below 3e-7; 0 at the origin.
/// Polynomial: Moshier. Cephes Mathematical Library, atanf. 1989.
inline float fast_atan2(float y, float x) {
    const float ax = std::fabs(x);
    const float ay = std::fabs(y);
    const float low = ax < ay ? ax : ay;
    const float high = ax < ay ? ay : ax;
    const bool upper = low > 0.41421356F * high;  // tan(pi / 8)
    const float numerator = upper ? low - high : low;
    const float denominator = upper ? low + high : high;
    const float t = numerator / (denominator > 0.0F ? denominator : 1.0F);
    const float s = t * t;
    const float series =
        (((8.05374449538e-2F * s - 1.38776856032e-1F) * s + 1.99777106478e-1F) * s -
         3.33329491539e-1F) *
            s * t +
        t;
    const float octant = upper ? 0.78539816340F + series : series;
    const float quadrant = ax < ay ? 1.57079632679F - octant : octant;
    const float half = x < 0.0F ? 3.14159265359F - quadrant : quadrant;
    return y < 0.0F ? -half : half;
}

/// Natural logarithm, relative error below 1e-11. @param x positive, normal.
inline double fast_log(double x) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    // Splits x = mantissa * 2^exponent with the mantissa in [sqrt(1/2), sqrt(2)).
    const std::uint64_t offset = bits - 0x3fe6a09e667f3bcdULL;
    const auto exponent = static_cast<std::int64_t>(offset) >> 52;
    const auto mantissa =
        std::bit_cast<double>(bits - (static_cast<std::uint64_t>(exponent) << 52U));
    const double t = (mantissa - 1.0) / (mantissa + 1.0);
    const double s = t * t;
    double series = 1.0 / 15.0;
    for (int odd = 13; odd >= 1; odd -= 2) series = series * s + 1.0 / odd;
    return 2.0 * t * series + static_cast<double>(exponent) * 0.69314718055994530942;
}

}  // namespace ostraka
