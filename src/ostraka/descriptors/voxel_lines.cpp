// SPDX-License-Identifier: Apache-2.0
// Eight lines of nearly the same length are traced side by side; where they are of one length, no
// lane is idle. Floor: eight voxels need a gather (5 to 6 cycles) and 15 other vector operations,
// at three a cycle, which overlap with it; ESF's 60,000 lines of 17 voxels are then 0.25 ms at 3
// GHz. Measured: about 0.5 ms with setting up and sorting the lines.
#include "ostraka/descriptors/voxel_lines.hpp"

#include <algorithm>

#include "ostraka/base/vector_clones.hpp"
#if OSTRAKA_HAS_AVX2_CLONES
#include <immintrin.h>
#endif

namespace ostraka {
namespace {

constexpr std::size_t kLines = 1536;  // traced together: their data and the grid fit the L1 cache
constexpr int kFraction = 26;         // bits after the point of a coordinate
constexpr float kOne = 1U << kFraction;

// to[lane] = table[at[lane]].
struct PlainGather {
    __attribute__((always_inline)) static void load(const std::uint32_t* table, const Word8& at,
                                                    Word8& to) {
        to = Word8{table[at[0]], table[at[1]], table[at[2]], table[at[3]],
                   table[at[4]], table[at[5]], table[at[6]], table[at[7]]};
    }
};

#if OSTRAKA_HAS_AVX2_CLONES
// The builtin instead of the intrinsic, so that functions without a target may be inlined into the
// clone together with it; none of them passes vectors between functions.
#pragma GCC diagnostic ignored "-Wpsabi"
struct Avx2Gather {
    __attribute__((always_inline)) static void load(const std::uint32_t* table, const Word8& at,
                                                    Word8& to) {
        const Int8 index = __builtin_convertvector(at, Int8);
        const Int8 words = __builtin_ia32_gathersiv8si(Int8{}, reinterpret_cast<const int*>(table),
                                                       index, Int8{} - 1, sizeof(int));
        to = __builtin_convertvector(words, Word8);
    }
};
#endif

// A coordinate of eight lines, as fixed point with 6 bits before the point; beyond their ends lines
// wrap around, so that they never leave the grid.
struct Axis {
    Word8 at, step;
};

__attribute__((always_inline)) inline void magnitude(const Int8& value, Int8& result) {
    result = value < 0 ? -value : value;
}

// After k of l steps with difference d, Bresenham's line has moved by floor((2dk + l - 1) / 2l)
// along an axis, backwards by as much for a negative d. That is floor(k * d / l + c), with c = (l -
// 1) / 2l forwards and 1/2 backwards. The values are multiples of 1 / 2l >= 1/128; the added 1/256
// keeps them off the steps of the floor, beyond the error of a float's step (64 * 2^-24).
__attribute__((always_inline)) inline void set_axis(const Word8& from, const Int8& difference,
                                                    const Float8& scale, Axis& axis) {
    const Int8 forward = __builtin_convertvector(0.5F * kOne - 0.5F * scale, Int8);
    const Int8 backward = Int8{} + (1 << (kFraction - 1));
    const Int8 offset = (difference < 0 ? backward : forward) + (1 << (kFraction - 8));
    const Int8 step =
        __builtin_convertvector(__builtin_convertvector(difference, Float8) * scale, Int8);
    axis.at = (from << kFraction) + __builtin_convertvector(offset, Word8);
    axis.step = __builtin_convertvector(step, Word8);
}

// The bits at the current voxels, lowest in each lane; moves on.
template <class Gather>
__attribute__((always_inline)) inline void look_up(const std::uint32_t* words, Axis& x, Axis& y,
                                                   Axis& z, Word8& found) {
    const Word8 at =
        (x.at >> (kFraction - 7) & 0x1f80U) | (y.at >> (kFraction - 1) & 0x7eU) | z.at >> 31;
    Word8 word;
    Gather::load(words, at, word);
    found = word >> (z.at >> kFraction & 31U) & 1U;
    x.at += x.step;
    y.at += y.step;
    z.at += z.step;
}

struct Block {
    const std::uint32_t *from, *to;  // packed voxels
    const std::uint8_t* length;
    const std::uint32_t* order;  // line numbers, shorter lines first, a multiple of eight
    std::size_t count;           // of the order
    std::uint8_t* inside;
};

template <class Gather>
__attribute__((always_inline)) inline void trace_block(const std::uint32_t* words,
                                                       const Block& block) {
    for (std::size_t first = 0; first < block.count; first += kVectorLanes) {
        const std::uint32_t* order = block.order + first;
        Word8 lines;
        Word8 from;
        Word8 to;
        load8(order, lines);
        Gather::load(block.from, lines, from);
        Gather::load(block.to, lines, to);
        const Word8 fx = from & 63U;
        const Word8 fy = from >> 8 & 63U;
        const Word8 fz = from >> 16;
        const Int8 dx = __builtin_convertvector((to & 63U) - fx, Int8);
        const Int8 dy = __builtin_convertvector((to >> 8 & 63U) - fy, Int8);
        const Int8 dz = __builtin_convertvector((to >> 16) - fz, Int8);
        Int8 length;
        Int8 other;
        magnitude(dx, length);
        magnitude(dy, other);
        length = length > other ? length : other;
        magnitude(dz, other);
        length = length > other ? length : other;
        length = length > 1 ? length : Int8{} + 1;
        const Float8 scale = kOne / __builtin_convertvector(length, Float8);
        Axis x;
        Axis y;
        Axis z;
        set_axis(fx, dx, scale, x);
        set_axis(fy, dy, scale, y);
        set_axis(fz, dz, scale, z);
        const std::int32_t shortest = block.length[order[0]];
        const std::int32_t longest = block.length[order[kVectorLanes - 1]];
        Word8 inside = {};
        Word8 found;
        for (std::int32_t k = 0; k < shortest; ++k) {
            look_up<Gather>(words, x, y, z, found);
            inside += found;
        }
        for (std::int32_t k = shortest; k < longest; ++k) {
            look_up<Gather>(words, x, y, z, found);
            const Int8 running = length > k;
            inside += found & __builtin_convertvector(running, Word8);
        }
        for (std::size_t lane = 0; lane < kVectorLanes; ++lane) {
            block.inside[order[lane]] = static_cast<std::uint8_t>(inside[lane]);
        }
    }
}

OSTRAKA_DEFAULT_CLONE
void trace(const std::uint32_t* words, const Block& block) {
    trace_block<PlainGather>(words, block);
}
#if OSTRAKA_HAS_AVX2_CLONES
OSTRAKA_AVX2_CLONE
void trace(const std::uint32_t* words, const Block& block) {
    trace_block<Avx2Gather>(words, block);
}
#endif

OSTRAKA_VECTOR_CLONES
void measure(const std::uint32_t* from, const std::uint32_t* to, std::size_t count,
             std::uint8_t* length) {
    for (std::size_t i = 0; i < count; ++i) {
        const auto f = static_cast<std::int32_t>(from[i]);
        const auto t = static_cast<std::int32_t>(to[i]);
        const std::int32_t x = (t & 63) - (f & 63);
        const std::int32_t y = (t >> 8 & 63) - (f >> 8 & 63);
        const std::int32_t z = (t >> 16) - (f >> 16);
        const std::int32_t ax = x < 0 ? -x : x;
        const std::int32_t ay = y < 0 ? -y : y;
        const std::int32_t az = z < 0 ? -z : z;
        const std::int32_t xy = ax > ay ? ax : ay;
        const std::int32_t xyz = xy > az ? xy : az;
        length[i] = static_cast<std::uint8_t>(xyz > 1 ? xyz : 1);
    }
}

using Order = std::array<std::uint32_t, kLines + kVectorLanes>;

// Line numbers in ascending order of length, the last one repeated up to a multiple of eight.
std::size_t sort_by_length(const std::uint8_t* length, std::size_t count, Order& order) {
    std::array<std::uint32_t, kVoxels + 1> next{};
    for (std::size_t i = 0; i < count; ++i) ++next[length[i]];
    std::uint32_t before = 0;
    for (std::uint32_t& n : next) {
        const std::uint32_t lines = n;
        n = before;
        before += lines;
    }
    for (std::uint32_t i = 0; i < count; ++i) order[next[length[i]]++] = i;
    std::size_t padded = count;
    for (; padded % kVectorLanes != 0; ++padded) order[padded] = order[count - 1];
    return padded;
}

// ORs `words` words of `from`, from `second` on, into `to`, from `first` on.
void merge_rows(const std::vector<std::uint64_t>& from, std::size_t first, std::size_t second,
                std::size_t words, std::vector<std::uint64_t>& to) {
    for (std::size_t i = 0; i < words; ++i) to[first + i] |= from[second + i];
}

}  // namespace

void VoxelGrid::set(std::uint32_t voxel) {
    const std::uint32_t x = voxel & 63U;
    const std::uint32_t y = voxel >> 8U & 63U;
    const std::uint32_t z = voxel >> 16U;
    words_[x * 2 * kVoxels + y * 2 + (z >> 5U)] |= 1U << (z & 31U);
}

void VoxelGrid::dilate() {
    constexpr std::size_t kRow = kVoxels;
    constexpr std::size_t kAll = kRow * kRow;
    std::vector<std::uint64_t> along_z(kAll);
    for (std::size_t i = 0; i < kAll; ++i) {
        const std::uint64_t bits = words_[2 * i] | std::uint64_t{words_[2 * i + 1]} << 32U;
        along_z[i] = bits | bits << 1U | bits >> 1U;
    }
    std::vector<std::uint64_t> along_y = along_z;
    for (std::size_t x = 0; x < kAll; x += kRow) {
        merge_rows(along_z, x, x + 1, kRow - 1, along_y);
        merge_rows(along_z, x + 1, x, kRow - 1, along_y);
    }
    std::vector<std::uint64_t> along_x = along_y;
    merge_rows(along_y, 0, kRow, kAll - kRow, along_x);
    merge_rows(along_y, kRow, 0, kAll - kRow, along_x);
    for (std::size_t i = 0; i < kAll; ++i) {
        words_[2 * i] = static_cast<std::uint32_t>(along_x[i]);
        words_[2 * i + 1] = static_cast<std::uint32_t>(along_x[i] >> 32U);
    }
}

void trace_lines(const VoxelGrid& grid, std::span<const std::uint32_t> from,
                 std::span<const std::uint32_t> to, std::span<std::uint8_t> visited,
                 std::span<std::uint8_t> inside) {
    Order order;
    for (std::size_t first = 0; first < from.size(); first += kLines) {
        const std::size_t count = std::min(kLines, from.size() - first);
        std::uint8_t* length = visited.data() + first;
        measure(from.data() + first, to.data() + first, count, length);
        const std::size_t padded = sort_by_length(length, count, order);
        trace(grid.words(), {from.data() + first, to.data() + first, length, order.data(), padded,
                             inside.data() + first});
    }
}

}  // namespace ostraka
