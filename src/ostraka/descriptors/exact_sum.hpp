// SPDX-License-Identifier: Apache-2.0
// Private to this module: sums that are the same bits for any order of their terms.
// Demmel, Nguyen. Fast Reproducible Floating-Point Summation. ARITH 2013 (one fold): every term is
// first rounded to a common grid that is coarse enough for all partial sums to be exact.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Rounds terms so that adding up to `count` of them in double is exact and so independent of
/// order. The error is below count * largest * 2^-52 a term.
class TermRounder {
  public:
    /// @param count  the most terms that are added.
    /// @param largest  bound of a term's magnitude; finite.
    TermRounder(std::size_t count, double largest) {
        int count_exponent = 0;
        int term_exponent = 0;
        std::frexp(static_cast<double>(count), &count_exponent);
        std::frexp(largest, &term_exponent);
        shift_ = std::ldexp(1.5, count_exponent + term_exponent);
    }
    double operator()(double term) const { return (term + shift_) - shift_; }
    /// For vectors: (term + shift()) - shift() is the rounded term.
    double shift() const { return shift_; }

  private:
    double shift_;
};

/// Mean of the points; the same bits for any order. @param points at least 1, finite.
Vec3d exact_centroid(std::span<const Vec3f> points);

/// Sum of (p - origin)(p - origin)^T; the same bits for any order.
Mat3d exact_scatter(std::span<const Vec3f> points, const Vec3d& origin);

/// The largest distance of a point to `origin`. @param points finite.
double largest_distance(std::span<const Vec3f> points, const Vec3d& origin);

}  // namespace ostraka
