// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/voxel_lines.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "ostraka/descriptors/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr int kFraction = 15;
constexpr std::array<int, 3> kShift = {0, 21, 43};
constexpr std::size_t kLanes = 8;
// 1 / length
constexpr std::array<float, kVoxels + 1> kInverse = [] {
    std::array<float, kVoxels + 1> inverse{};
    inverse[0] = 1.0F;
    for (std::size_t l = 1; l <= kVoxels; ++l) inverse[l] = 1.0F / static_cast<float>(l);
    return inverse;
}();

using Word4 = std::uint64_t __attribute__((vector_size(32)));

// Lines of nearly the same length, side by side.
struct Lanes {
    std::array<std::uint64_t, kLanes> position, step, length, inside;
};

__attribute__((always_inline)) inline void load4(const std::uint64_t* from, Word4& to) {
    std::memcpy(&to, from, sizeof(to));
}

// Adds to `inside` the voxels at `p`, one a lane.
__attribute__((always_inline)) inline void look_up(const std::uint64_t* words, const Word4& p,
                                                   const Word4& counts, Word4& inside) {
    const Word4 at = (p >> (kFraction - 6) & 0xfc0U) | (p >> (kShift[1] + kFraction) & 0x3fU);
    const Word4 word = {words[at[0]], words[at[1]], words[at[2]], words[at[3]]};
    inside += word >> (p >> (kShift[2] + kFraction)) & counts;
}

OSTRAKA_VECTOR_CLONES
void trace_lanes(const std::uint64_t* words, Lanes& lanes, std::uint64_t steps) {
    Word4 p;
    Word4 q;
    Word4 p_step;
    Word4 q_step;
    Word4 p_length;
    Word4 q_length;
    load4(lanes.position.data(), p);
    load4(lanes.position.data() + 4, q);
    load4(lanes.step.data(), p_step);
    load4(lanes.step.data() + 4, q_step);
    load4(lanes.length.data(), p_length);
    load4(lanes.length.data() + 4, q_length);
    Word4 p_inside = {};
    Word4 q_inside = {};
    for (std::uint64_t k = 0; k < steps; ++k) {
        // A lane counts until its line ends; beyond, it may read any word, but none outside the
        // grid.
        const Word4 now = Word4{} + k;
        look_up(words, p, p_length > now ? Word4{} + 1 : Word4{}, p_inside);
        look_up(words, q, q_length > now ? Word4{} + 1 : Word4{}, q_inside);
        p += p_step;
        q += q_step;
    }
    std::memcpy(lanes.inside.data(), &p_inside, sizeof(p_inside));
    std::memcpy(lanes.inside.data() + 4, &q_inside, sizeof(q_inside));
}

// Line numbers in ascending order of length.
std::vector<std::uint32_t> by_length(std::span<const VoxelLine> lines) {
    std::array<std::uint32_t, kVoxels + 2> starts{};
    for (const VoxelLine& line : lines) ++starts[static_cast<std::size_t>(line.length) + 1];
    for (std::size_t l = 1; l < starts.size(); ++l) starts[l] += starts[l - 1];
    std::vector<std::uint32_t> order(lines.size());
    for (std::uint32_t i = 0; i < lines.size(); ++i) {
        order[starts[static_cast<std::size_t>(lines[i].length)]++] = i;
    }
    return order;
}

}  // namespace

void VoxelGrid::add_dilated(int x, int y, int z) {
    const std::uint64_t run = z > 0 ? std::uint64_t{7} << (z - 1) : std::uint64_t{3};
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, kVoxels - 1); ++i) {
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, kVoxels - 1); ++j) {
            words_[static_cast<std::size_t>(i * kVoxels + j)] |= run;
        }
    }
}

// After k of l steps with difference d, Bresenham's line has moved by floor((2dk + l - 1) / 2l)
// along an axis, backwards by as much for a negative d. That is floor(k * d / l + c), with c = (l -
// 1) / 2l forwards and 1/2 backwards. The values are multiples of 1 / 2l >= 1/128; the added 1/256
// keeps them off the steps of the floor, beyond the error of the fixed-point step (64 * 2^-15 =
// 1/512).
VoxelLine voxel_line(const std::array<std::int32_t, 3>& from,
                     const std::array<std::int32_t, 3>& to) {
    constexpr float kOne = 1 << kFraction;
    VoxelLine line;
    const std::int32_t dx = to[0] - from[0];
    const std::int32_t dy = to[1] - from[1];
    const std::int32_t dz = to[2] - from[2];
    line.length = std::max({std::abs(dx), std::abs(dy), std::abs(dz), 1});
    const float scale = kOne * kInverse[static_cast<std::size_t>(line.length)];
    const auto forward =
        static_cast<std::int64_t>(0.5F * kOne - 0.5F * scale) + (1 << (kFraction - 8));
    const std::int64_t backward = (1 << (kFraction - 1)) + (1 << (kFraction - 8));
    const auto add_axis = [&](std::int32_t start, std::int32_t d, int shift) {
        const std::int64_t position =
            (std::int64_t{start} << kFraction) + (d < 0 ? backward : forward);
        const auto step = static_cast<std::int64_t>(static_cast<float>(d) * scale);
        line.start += static_cast<std::uint64_t>(position) << shift;
        line.step += static_cast<std::uint64_t>(step) << shift;
    };
    add_axis(from[0], dx, kShift[0]);
    add_axis(from[1], dy, kShift[1]);
    add_axis(from[2], dz, kShift[2]);
    return line;
}

void trace_lines(const VoxelGrid& grid, std::span<const VoxelLine> lines,
                 std::span<std::int32_t> inside) {
    const std::vector<std::uint32_t> order = by_length(lines);
    Lanes lanes{};
    for (std::size_t first = 0; first < order.size(); first += kLanes) {
        const std::size_t count = std::min(kLanes, order.size() - first);
        for (std::size_t lane = 0; lane < count; ++lane) {
            const VoxelLine& line = lines[order[first + lane]];
            lanes.position[lane] = line.start;
            lanes.step[lane] = line.step;
            lanes.length[lane] = static_cast<std::uint64_t>(line.length);
        }
        trace_lanes(grid.words(), lanes, lanes.length[count - 1]);
        for (std::size_t lane = 0; lane < count; ++lane) {
            inside[order[first + lane]] = static_cast<std::int32_t>(lanes.inside[lane]);
        }
    }
}

}  // namespace ostraka
