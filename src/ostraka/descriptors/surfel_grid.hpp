// SPDX-License-Identifier: Apache-2.0
// Private to this module: points with normals, sorted into cubic cells and kept as columns, for
// work on all points within a radius. Search by cells needs no tree, no sorting by distance and no
// list of neighbors for each point: points of one cell share the copy of what lies around it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Points as columns, padded by kVectorLanes - 1 points that are farther than any radius.
struct SurfelColumns {
    std::size_t count = 0;                   // without the padding
    std::vector<float> x, y, z, nx, ny, nz;  // the points' frame and unit; normals 0 if not given
    std::vector<std::uint32_t> slot;         // position in the grid's order

    void resize(std::size_t points);
    void pad();
};

/// Points in an order that depends on the points only, not on the order they are given in: by cell,
/// then by coordinates, then by normals. So sums in this order are the same bits for any order of
/// the points.
class SurfelGrid {
  public:
    /// @param points  all usable (see checks.hpp).
    /// @param normals  empty, or one a point; points with a normal that is not finite are left out.
    /// @param radius  of the balls that will be asked for; positive.
    SurfelGrid(std::span<const Vec3f> points, std::span<const Vec3f> normals, float radius);

    /// Points in the grid.
    std::size_t size() const { return index_.size(); }
    /// The point that was given at this index stands in slot order_position.
    std::span<const std::uint32_t> original() const { return index_; }
    const SurfelColumns& columns() const { return columns_; }

    /// Occupied cells, and the slots [first, last) of each.
    std::size_t cell_count() const { return cells_.size() - 1; }
    std::uint32_t cell_begin(std::size_t cell) const { return cells_[cell]; }

    /// Copies all points closer than the radius to the bounding box of the slots [first, last), in
    /// the order of their slots, into `found` (replaced). Safe from many threads.
    void gather(std::size_t first, std::size_t last, SurfelColumns& found) const;
    /// Copies all points closer than the radius to `center`, likewise.
    void gather(const Vec3f& center, SurfelColumns& found) const;
    /// The same with another radius; fast where it is not far from the grid's own.
    void gather(const Vec3f& center, float radius, SurfelColumns& found) const;

  private:
    struct Box {
        Vec3f low, high;
    };
    std::int64_t cell_along(int axis, double coordinate) const;
    void sort_points(std::span<const Vec3f> points, std::span<const Vec3f> normals);
    void gather_box(const Box& box, float radius, SurfelColumns& found) const;

    float radius_;
    double cell_ = 1.0;
    Vec3d low_ = Vec3d::Zero();
    Eigen::Matrix<std::int64_t, 3, 1> dims_ = {1, 1, 1};
    std::vector<std::uint32_t> starts_;  // of each cell, x fastest; one more than cells
    std::vector<std::uint32_t> cells_;   // starts of the occupied cells; one more than cells
    std::vector<std::uint32_t> index_;   // slot -> index as given
    SurfelColumns columns_;
};

}  // namespace ostraka
