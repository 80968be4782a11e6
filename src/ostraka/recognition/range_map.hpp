// SPDX-License-Identifier: Apache-2.0
// What the sensor measured in each direction: where the scan has surface, and where it saw free
// space. Stereographic projection about the scan's middle, which works up to nearly the whole
// sphere.
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/recognition/range_shadows.hpp"

namespace ostraka {

class RangeMap {
  public:
    /// @param raw        the scan at its own density; invalid points are left out.
    /// @param wall_extents  of each raw point: that of the wall or table it is on, or 0; or empty.
    /// @param resampled  the same scan without walls and tables at the library's sampling distance;
    /// without normals no cell
    ///                   is steady.
    /// @param side       of a cell at the scan's median distance.
    RangeMap(const PointCloud& raw, std::span<const float> wall_extents,
             const PointCloud& resampled, double side);

    /// The number of the cell that shows `point`, or kNoIndex outside the map.
    std::uint32_t cell_of(const Vec3f& point) const {
        const Vec3f offset = R_map_scene_ * (point - viewpoint_);
        const float range = offset.norm();
        const float depth = range + offset.z();
        if (!(depth > 1e-6F * range)) return kNoIndex;
        const float scale = cells_per_radian_ / depth;
        const float u = offset.x() * scale - low_u_;
        const float v = offset.y() * scale - low_v_;
        if (!(u >= 0.0F && v >= 0.0F)) return kNoIndex;
        if (!(u < static_cast<float>(width_) && v < static_cast<float>(height_))) return kNoIndex;
        return static_cast<std::uint32_t>(v) * width_ + static_cast<std::uint32_t>(u);
    }
    const RangeCell& operator[](std::uint32_t cell) const { return cells_[cell]; }
    std::size_t size() const { return cells_.size(); }
    /// Unit direction in the scan's frame through the middle of a cell.
    Vec3d direction(std::uint32_t cell) const;
    /// The cells whose directions may meet a ball, ascending: a rectangle around its outline.
    std::vector<std::uint32_t> cells_around(const Vec3d& center, double radius) const;
    const Vec3f& viewpoint() const { return viewpoint_; }
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }

  private:
    std::vector<float> place_axis(const PointCloud& raw);
    void set_extent(const PointCloud& raw, float middle, double side);
    void fill(const PointCloud& raw, std::span<const float> ranges,
              std::span<const float> wall_extents);
    void place_points(const PointCloud& resampled);
    void fill_gaps();
    void fill_gap(std::uint32_t u, std::uint32_t v, RangeCell& cell) const;
    void look_around(const PointCloud& resampled);
    void look_around(const PointCloud& resampled, std::uint32_t u, std::uint32_t v);

    Vec3f viewpoint_ = Vec3f::Zero();
    Mat3f R_map_scene_ = Mat3f::Identity();
    float cells_per_radian_ =
        1.0F;  // twice the focal length of the stereographic projection, in cells
    float low_u_ = 0.0F;
    float low_v_ = 0.0F;
    std::uint32_t width_ = 0;
    std::uint32_t height_ = 0;
    std::vector<RangeCell> cells_;
};

}  // namespace ostraka
