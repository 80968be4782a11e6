// SPDX-License-Identifier: Apache-2.0
// Private to this module: the distance field of oriented points, in blocks of a sparse grid.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

inline constexpr int kBlockSide = 8;       ///< cells along a side of a block
inline constexpr float kReach = 2.0F;      ///< of a weight, in its radii
inline constexpr float kLongReach = 8.0F;  ///< the longest reach of a point, in cells

/// An oriented point; all lengths in cells of the grid, coordinates not negative.
struct Splat {
    Vec3f point;
    Vec3f normal;
    float radius;  ///< of the weight; at most kLongReach / kReach
};

/// What the near points say about a place.
struct FieldValue {
    float weight = 0.0F;           ///< sum of weights; 0 if no point is near
    float distance = 0.0F;         ///< to the surface, positive outside
    float radius = 0.0F;           ///< mean radius of the weights
    Vec3f normal = Vec3f::Zero();  ///< mean; not of unit length
    Vec3f aside = Vec3f::Zero();   ///< from the place to the mean of the points
};
/// @param facing  a unit vector: points of surface that faces the other way, the back of a thin
/// wall,
///                are left out; or zero.
FieldValue field_at(const Vec3f& place, std::span<const Splat> splats, const Vec3f& facing);

/// Blocks that a point reaches, in ascending order.
class DistanceBlocks {
  public:
    explicit DistanceBlocks(std::span<const Splat> splats);

    std::size_t size() const { return keys_.size(); }
    /// The lowest corner of a block, in cells.
    Eigen::Vector3i origin(std::size_t block) const;
    /// The block that holds a cell, or kNoIndex.
    std::uint32_t find(const Eigen::Vector3i& cell) const;
    /// The splats that reach into a block, in an order that is the same in all blocks.
    void gather(std::size_t block, std::vector<Splat>& near) const;

  private:
    std::span<const Splat> splats_;
    std::vector<std::uint64_t> held_;   // keys of blocks that hold points, ascending
    std::vector<std::uint32_t> start_;  // of each, and the end
    std::vector<std::uint32_t> order_;  // splats by block
    std::vector<std::uint64_t> keys_;   // those and all around them, ascending
};

inline constexpr int kCorners = kBlockSide + 1;  ///< of the cells of a block along an axis

/// The distances at the corners of a block's cells, x fastest; NaN where no point is near. Corners
/// that blocks share get the same bits in each.
void fill_distances(const Eigen::Vector3i& origin, std::span<const Splat> near,
                    std::vector<float>& distances);

}  // namespace ostraka
