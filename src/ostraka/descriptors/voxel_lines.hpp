// SPDX-License-Identifier: Apache-2.0
// Private to this module: a grid of 64^3 bits and lines traced through it, for ESF.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace ostraka {

inline constexpr int kVoxels = 64;  // along each axis

/// A voxel's coordinates, each in [0, 64), in one word: x lowest, a byte each.
inline std::uint32_t pack_voxel(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return x | y << 8U | z << 16U;
}

/// One bit a voxel; z runs along the bits of two words. 32 KiB, which fits the L1 cache.
class VoxelGrid {
  public:
    VoxelGrid() : words_(kVoxels * kVoxels * 2, 0) {}
    /// Sets a voxel. @param voxel  see pack_voxel().
    void set(std::uint32_t voxel);
    /// Sets the 26 neighbors of every set voxel.
    void dilate();
    const std::uint32_t* words() const { return words_.data(); }

  private:
    std::vector<std::uint32_t> words_;
};

/// Lines from voxel to voxel, without the end; at least the start: the voxels that a Bresenham line
/// with PCL's rounding visits.
/// @param from, to  packed voxels, as many as lines.
/// @param visited  the number of voxels on each line: the largest coordinate difference, at
/// least 1.
/// @param inside  how many of them are set.
void trace_lines(const VoxelGrid& grid, std::span<const std::uint32_t> from,
                 std::span<const std::uint32_t> to, std::span<std::uint8_t> visited,
                 std::span<std::uint8_t> inside);

}  // namespace ostraka
