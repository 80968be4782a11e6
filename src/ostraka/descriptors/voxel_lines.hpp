// SPDX-License-Identifier: Apache-2.0
// Private to this module: a grid of 64^3 bits and lines traced through it, for ESF.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace ostraka {

inline constexpr int kVoxels = 64;  // along each axis

/// One bit a voxel; z runs along the bits of a word. 32 KiB, which fits the L1 cache.
class VoxelGrid {
  public:
    /// Sets the voxel and its 26 neighbors. @param x, y, z in [0, 64).
    void add_dilated(int x, int y, int z);
    const std::uint64_t* words() const { return words_.data(); }

  private:
    std::array<std::uint64_t, kVoxels * kVoxels> words_{};
};

/// A voxel line: from a start voxel up to, not including, its end; at least the start.
/// Coordinates are packed as fixed point, 6 bits before and 15 after the point, x and y at bits 0
/// and 21, z at 43, so that one addition moves along all axes.
struct VoxelLine {
    std::uint64_t start = 0;
    std::uint64_t step = 0;
    std::int32_t length = 1;  // voxels visited: the largest coordinate difference, at least 1
};

/// The voxels that a Bresenham line with PCL's rounding visits.
VoxelLine voxel_line(const std::array<std::int32_t, 3>& from,
                     const std::array<std::int32_t, 3>& to);

/// Counts the set voxels on each line. @param inside  as many as lines.
void trace_lines(const VoxelGrid& grid, std::span<const VoxelLine> lines,
                 std::span<std::int32_t> inside);

}  // namespace ostraka
