// SPDX-License-Identifier: Apache-2.0
// Sums over two rows of numbers, for functions compiled with OSTRAKA_VECTOR_CLONES.
#pragma once

#include <array>
#include <cstddef>

namespace ostraka {

/// The sum of partial sums in a fixed order.
/// @tparam Lanes  a power of two.
template <std::size_t Lanes>
__attribute__((always_inline)) inline float sum_of_lanes(std::array<float, Lanes>& sums) {
    for (std::size_t half = Lanes / 2; half > 0; half /= 2) {
        for (std::size_t lane = 0; lane < half; ++lane) sums[lane] += sums[lane + half];
    }
    return sums[0];
}

/// Sum of term(a[i], b[i]) in `Lanes` partial sums, added in a fixed order: so compilers may
/// vectorize, and the bits are the same whatever vectors the machine has.
/// @tparam Lanes  a power of two; 16 are two vectors, so that additions overlap.
template <std::size_t Lanes, class A, class B, class Term>
__attribute__((always_inline)) inline float sum_in_lanes(const A* a, const B* b, std::size_t length,
                                                         const Term& term) {
    std::array<float, Lanes> sums{};
    std::size_t i = 0;
    for (; i + Lanes <= length; i += Lanes) {
        for (std::size_t lane = 0; lane < Lanes; ++lane) {
            sums[lane] += term(a[i + lane], b[i + lane]);
        }
    }
    for (; i < length; ++i) sums[i % Lanes] += term(a[i], b[i]);
    return sum_of_lanes(sums);
}

}  // namespace ostraka
