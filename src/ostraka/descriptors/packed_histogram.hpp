// SPDX-License-Identifier: Apache-2.0
// Private to this module: a histogram of 11 bins that is counted in registers. Counters of 5 bits
// stand in each 64-bit lane; voting is a shift and an addition for eight values at once, and
// never waits for memory as counting in an array does when many values fall into one bin.
#pragma once

#include <cstdint>

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {

using Long4 = std::uint64_t __attribute__((vector_size(32)));

struct PackedHistogram {
    static constexpr int kBins = 11;
    static constexpr int kField = 5;
    static constexpr std::size_t kVotes = 15;    // calls of vote8(), until widen() is due
    static constexpr std::size_t kWidened = 34;  // calls of widen(), until unpack() is due
    static constexpr std::uint64_t kEveryOther = 0x007c1f07c1f07c1fULL;

    Long4 packed = {};
    Long4 even = {};  // counters of 10 bits
    Long4 odd = {};
};

/// Ones for the lanes that vote, apart for the even and the odd ones.
struct Voters8 {
    Long4 even, odd;
};

/// @param voting  masks.
__attribute__((always_inline)) inline void select_voters(const Int8& voting, Voters8& voters) {
    const auto pairs = reinterpret_cast<Long4>(voting);
    voters.even = pairs & 1U;
    voters.odd = pairs >> 63U;
}

/// One vote for each value that votes. @param shifts  5 x bin.
__attribute__((always_inline)) inline void vote8(PackedHistogram& histogram, const Int8& shifts,
                                                 const Voters8& voters) {
    const auto pairs = reinterpret_cast<Long4>(shifts);
    histogram.packed += (voters.even << (pairs & 0xffffffffULL)) + (voters.odd << (pairs >> 32U));
}

/// Makes room in the small counters.
__attribute__((always_inline)) inline void widen(PackedHistogram& histogram) {
    histogram.even += histogram.packed & PackedHistogram::kEveryOther;
    histogram.odd += (histogram.packed >> PackedHistogram::kField) & PackedHistogram::kEveryOther;
    histogram.packed = Long4{};
}

/// Adds all counters to `bins` (11) and clears them; after widen().
__attribute__((always_inline)) inline void unpack(PackedHistogram& histogram, std::int32_t* bins) {
    for (int b = 0; b < PackedHistogram::kBins; ++b) {
        const Long4 fields = (b % 2 == 0 ? histogram.even : histogram.odd) >>
                             static_cast<std::uint64_t>(2 * PackedHistogram::kField * (b / 2));
        const Long4 counts = fields & 0x3ffU;
        bins[b] += static_cast<std::int32_t>(counts[0] + counts[1] + counts[2] + counts[3]);
    }
    histogram.even = histogram.odd = Long4{};
}

}  // namespace ostraka
