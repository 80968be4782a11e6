// SPDX-License-Identifier: Apache-2.0
// The nearest surface point to any place near a model, by one table look-up: thousands of
// hypotheses can be refined and scored at a few microseconds each.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

/// A voxel grid over a surface; each cell knows the surface point nearest to its center.
class SurfaceField {
  public:
    /// @param surface  points with unit normals, at least 1; copied.
    /// @param cell     side of a cell, in the points' unit; enlarged if the grid would exceed 2^21
    /// cells.
    /// @param margin   how far beyond the surface's bounding box the field reaches.
    SurfaceField(const PointCloud& surface, double cell, double margin);

    /// The index of a surface point about nearest to `point` (within a cell's diagonal), or
    /// kNoIndex outside the grid.
    std::uint32_t nearest(const Vec3f& point) const { return nearest_in(cell_of(point)); }
    /// The same in two steps, for loops that fetch() what later steps need: the cell's number, or
    /// kNoIndex outside the grid.
    std::uint32_t cell_of(const Vec3f& point) const {
        const Vec3f at = (point - low_) * inverse_cell_;
        // Compared as floats: a NaN or a far point doesn't fit an int.
        const bool inside = at.x() >= 0.0F && at.y() >= 0.0F && at.z() >= 0.0F &&
                            at.x() < static_cast<float>(size_[0]) &&
                            at.y() < static_cast<float>(size_[1]) &&
                            at.z() < static_cast<float>(size_[2]);
        if (!inside) return kNoIndex;
        return offset(static_cast<int>(at.x()), static_cast<int>(at.y()), static_cast<int>(at.z()));
    }
    std::uint32_t nearest_in(std::uint32_t cell) const {
        return cell == kNoIndex ? kNoIndex : nearest_[cell];
    }
    void fetch_cell(std::uint32_t cell) const {
        if (cell != kNoIndex) __builtin_prefetch(&nearest_[cell]);
    }
    void fetch(std::uint32_t index) const {
        if (index != kNoIndex) __builtin_prefetch(&elements_[index]);
    }
    const Vec3f& point(std::uint32_t index) const { return elements_[index].point; }
    const Vec3f& normal(std::uint32_t index) const { return elements_[index].normal; }
    std::size_t size() const { return elements_.size(); }

  private:
    // One line of the cache, as both are always needed.
    struct alignas(32) Element {
        Vec3f point;
        Vec3f normal;
    };
    std::uint32_t offset(int x, int y, int z) const {
        return static_cast<std::uint32_t>((z * size_[1] + y) * size_[0] + x);
    }
    Vec3f center(int x, int y, int z, double cell) const;
    // `squared`: of each cell, the distance from its center to its point.
    void seed_cells(double cell, std::vector<float>& squared);
    void sweep(double cell, std::vector<float>& squared);
    void sweep_row(int y, int z, int direction, double cell, std::vector<float>& squared);
    void offer(std::size_t own, std::uint32_t other, const Vec3f& middle,
               std::vector<float>& squared);

    std::vector<Element> elements_;
    Vec3f low_ = Vec3f::Zero();
    float inverse_cell_ = 1.0F;
    std::array<int, 3> size_ = {0, 0, 0};
    std::vector<std::uint32_t> nearest_;
};

}  // namespace ostraka
