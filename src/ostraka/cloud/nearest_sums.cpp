// SPDX-License-Identifier: Apache-2.0
// The k nearest candidates are not sorted: a squared distance is sought below which exactly k of
// them lie, by counting. On a surface the count grows evenly with the squared distance, so
// interpolating between counts takes three or four rounds.
//
// Floor: a point of a surface needs its k neighbors' coordinates (12 k bytes, from the cache) and
// 18 k multiplications and additions; at k = 20 and 8 lanes that is about 30 cycles. Of 5 to 6 k
// candidates each is measured, counted three or four times and summed: 10 to 15 times the floor.
#include "ostraka/cloud/nearest_sums.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr std::size_t kLanes = Candidates::kLanes;
constexpr int kRounds = 20;          // of counting, before ties are taken apart
constexpr float kWiden = 1.00001F;   // beyond rounding
constexpr double kLineShare = 1e-3;  // of the trace squared in the sum of principal minors

using Float4 = float __attribute__((vector_size(16)));
using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Double4 = double __attribute__((vector_size(32)));

struct Bracket {
    float low = 0.0F;   // fewer than k are below
    float high = 0.0F;  // at least k are below
    std::size_t below_low = 0;
    std::size_t below_high = 0;
};

__attribute__((always_inline)) inline void load8(const float* from, Float8& to) {
    std::memcpy(&to, from, sizeof(to));
}

// The sum of lanes that each count a few candidates, in pairs: no carry passes from one to the
// next.
__attribute__((always_inline)) inline std::size_t sum_of(const Int8& counts) {
    std::array<std::uint64_t, 4> pairs;
    std::memcpy(pairs.data(), &counts, sizeof(counts));
    const std::uint64_t pair = (pairs[0] + pairs[2]) + (pairs[1] + pairs[3]);
    return static_cast<std::size_t>((pair & 0xffffffffU) + (pair >> 32U));
}

__attribute__((always_inline)) inline std::size_t count_below(const float* squared,
                                                              std::size_t padded, float limit) {
    Int8 count = {};
    for (std::size_t i = 0; i < padded; i += kLanes) {
        Float8 value;
        load8(squared + i, value);
        count -= value < limit;  // a lane is -1 where true
    }
    return sum_of(count);
}

// Measures all candidates and narrows the bracket until exactly k are below its upper end, or the
// rounds are used up (ties).
// @return false if the candidates don't hold the k nearest for sure.
OSTRAKA_VECTOR_CLONES
bool bracket_nearest(const float* x, const float* y, const float* z, float* squared,
                     std::size_t count, std::size_t padded, const Query& query, std::size_t k,
                     float guess, Bracket& bracket) {
    Int8 below_covered = {};
    Int8 below_guess = {};
    const Float8 guesses = Float8{} + guess;
    Float8 farthest = {};
    const Float8 far = Float8{} + kFar;
    const Float8 qx = Float8{} + query.x;
    const Float8 qy = Float8{} + query.y;
    const Float8 qz = Float8{} + query.z;
    const Float8 covered = Float8{} + query.covered;
    for (std::size_t i = 0; i < padded; i += kLanes) {
        Float8 dx;
        Float8 dy;
        Float8 dz;
        load8(x + i, dx);
        load8(y + i, dy);
        load8(z + i, dz);
        dx = qx - dx;
        dy = qy - dy;
        dz = qz - dz;
        const Float8 distance = dx * dx + dy * dy + dz * dz;
        below_covered -= distance < covered;
        below_guess -= distance < guesses;
        farthest = (distance > farthest) & (distance < far) ? distance : farthest;
        std::memcpy(squared + i, &distance, sizeof(distance));
    }
    float high = query.covered;
    if (high == kFar) {
        high = 0.0F;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            high = farthest[lane] > high ? farthest[lane] : high;
        }
        high = high * kWiden + std::numeric_limits<float>::min();
        bracket = {0.0F, high, 0, count};
    } else {
        bracket = {0.0F, high, 0, sum_of(below_covered)};
    }
    if (bracket.below_high < k) return false;
    float limit = guess;
    for (int round = 0; round < kRounds && bracket.below_high > k; ++round) {
        if (!(limit > bracket.low && limit < bracket.high)) {
            const float share =
                (static_cast<float>(static_cast<int>(k - bracket.below_low)) + 0.5F) /
                static_cast<float>(static_cast<int>(bracket.below_high - bracket.below_low));
            // Halving now and then: counts far from k say little where points are unevenly spread.
            limit = bracket.low + (round % 4 == 3 ? 0.5F : share) * (bracket.high - bracket.low);
            if (!(limit > bracket.low && limit < bracket.high)) break;
        }
        const std::size_t below =
            limit == guess ? sum_of(below_guess) : count_below(squared, padded, limit);
        if (below < k) {
            bracket.low = limit;
            bracket.below_low = below;
        } else {
            bracket.high = limit;
            bracket.below_high = below;
        }
        limit = 0.0F;
    }
    return true;
}

__attribute__((always_inline)) inline void masked_offset(const float* from, float origin,
                                                         const Int8& mask, Float8& to) {
    load8(from, to);
    to -= origin;
    Int8 bits;
    std::memcpy(&bits, &to, sizeof(bits));
    bits &= mask;
    std::memcpy(&to, &bits, sizeof(bits));
}

// Sums over the candidates below the limit, into one lane of a batch: products in single precision,
// of which each of 8 sums gets a few; these are added in double.
OSTRAKA_VECTOR_CLONES
void sum_below(const float* x, const float* y, const float* z, const float* squared,
               std::size_t padded, const Query& query, float limit, MomentBatch& batch,
               std::size_t lane) {
    Float8 total[9] = {};
    for (std::size_t i = 0; i < padded; i += kLanes) {
        Float8 distance;
        load8(squared + i, distance);
        const Int8 mask = distance < limit;
        Float8 dx;
        Float8 dy;
        Float8 dz;
        masked_offset(x + i, query.x, mask, dx);
        masked_offset(y + i, query.y, mask, dy);
        masked_offset(z + i, query.z, mask, dz);
        total[0] += dx;
        total[1] += dy;
        total[2] += dz;
        total[3] += dx * dx;
        total[4] += dx * dy;
        total[5] += dx * dz;
        total[6] += dy * dy;
        total[7] += dy * dz;
        total[8] += dz * dz;
    }
    for (std::size_t s = 0; s < 9; ++s) {
        std::array<Float4, 2> halves;
        std::memcpy(&halves, &total[s], sizeof(total[s]));
        const Double4 sum = __builtin_convertvector(halves[0], Double4) +
                            __builtin_convertvector(halves[1], Double4);
        batch.sums[s][lane] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }
}

// Whether the neighbors lie so nearly on a line that single precision says little of their plane.
bool nearly_line(const MomentBatch& batch, std::size_t lane) {
    std::array<double, 9> s;
    for (std::size_t k = 0; k < 9; ++k) s[k] = batch.sums[k][lane] / batch.neighbors;
    const double xx = s[3] - s[0] * s[0];
    const double xy = s[4] - s[0] * s[1];
    const double xz = s[5] - s[0] * s[2];
    const double yy = s[6] - s[1] * s[1];
    const double yz = s[7] - s[1] * s[2];
    const double zz = s[8] - s[2] * s[2];
    const double minors = (yy * zz - yz * yz) + (xx * zz - xz * xz) + (xx * yy - xy * xy);
    const double trace = xx + yy + zz;
    return !(minors > kLineShare * trace * trace);
}

// The same sums in double throughout.
void sum_exactly(const Candidates& near, const Query& query, float limit, MomentBatch& batch,
                 std::size_t lane) {
    std::array<double, 9> sums{};
    for (std::size_t i = 0; i < near.count; ++i) {
        if (!(near.squared[i] < limit)) continue;
        const double x = double{near.x[i]} - double{query.x};
        const double y = double{near.y[i]} - double{query.y};
        const double z = double{near.z[i]} - double{query.z};
        const std::array<double, 9> terms = {x, y, z, x * x, x * y, x * z, y * y, y * z, z * z};
        for (std::size_t s = 0; s < 9; ++s) sums[s] += terms[s];
    }
    for (std::size_t s = 0; s < 9; ++s) batch.sums[s][lane] = sums[s];
}

// Where the k-th distance occurs several times: of the points between the bracket's ends only the
// nearest, then those of the lowest indices, stay.
void break_ties(Candidates& near, std::size_t k, const Bracket& bracket) {
    thread_local std::vector<std::pair<float, std::uint32_t>> doubtful;  // distance, index
    thread_local std::vector<std::uint32_t> places;
    doubtful.clear();
    places.clear();
    for (std::uint32_t i = 0; i < near.count; ++i) {
        if (!(near.squared[i] >= bracket.low && near.squared[i] < bracket.high)) continue;
        doubtful.emplace_back(near.squared[i], near.index[i]);
        places.push_back(i);
    }
    const std::size_t wanted = k - bracket.below_low;
    if (wanted >= doubtful.size()) return;
    auto last = doubtful.begin() + static_cast<std::ptrdiff_t>(wanted - 1);
    std::nth_element(doubtful.begin(), last, doubtful.end());
    const auto limit = *last;
    for (const std::uint32_t i : places) {
        if (std::pair(near.squared[i], near.index[i]) > limit) near.squared[i] = kFar;
    }
}

}  // namespace

bool sum_nearest(Candidates& near, const Query& query, std::size_t k, float& guess,
                 MomentBatch& batch, std::size_t lane) {
    Bracket bracket;
    if (!bracket_nearest(near.x.data(), near.y.data(), near.z.data(), near.squared.data(),
                         near.count, near.padded, query, k, guess, bracket)) {
        return false;
    }
    if (bracket.below_high > k) break_ties(near, k, bracket);
    sum_below(near.x.data(), near.y.data(), near.z.data(), near.squared.data(), near.padded, query,
              bracket.high, batch, lane);
    if (nearly_line(batch, lane)) sum_exactly(near, query, bracket.high, batch, lane);
    guess = bracket.high;
    return true;
}

float kth_squared_distance(Candidates& near, const Query& query, std::size_t k, float guess) {
    Bracket bracket;
    bracket_nearest(near.x.data(), near.y.data(), near.z.data(), near.squared.data(), near.count,
                    near.padded, query, k, guess, bracket);
    return bracket.high;
}

}  // namespace ostraka
