// SPDX-License-Identifier: Apache-2.0
// Seeded random numbers that are the same on every platform (the standard distributions are not).
// Generator: O'Neill. PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms
// for Random Number Generation. 2014 (PCG-XSH-RR 64/32). Seeds are mixed by SplitMix64.
#pragma once

#include <cstdint>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// One stream of random numbers; streams of the same seed and different items are independent, so
/// that the order in which threads handle items cannot matter.
class Random {
  public:
    explicit Random(std::uint64_t seed, std::uint64_t item = 0);

    /// 32 uniform bits.
    std::uint32_t bits();
    /// Uniform in [0, 1), 53 bits.
    double uniform();
    /// Uniform in [low, high).
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Uniform integer in [0, count), unbiased. @param count at least 1.
    std::uint32_t below(std::uint32_t count);
    /// Normal with mean 0 and deviation 1 (Marsaglia's polar method).
    double normal();
    /// Uniform on the unit sphere.
    Vec3d direction();
    /// Uniform rotation (Shoemake 1992).
    Mat3d rotation();

  private:
    std::uint64_t state_;
    std::uint64_t increment_;
};

}  // namespace ostraka
