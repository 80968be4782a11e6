// SPDX-License-Identifier: Apache-2.0
// Private to this module: the plane of a growing region, and whether a region bends.
#pragma once

#include <span>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

/// Sums over points, from which their plane follows. Offsets from `origin` keep digits.
class PlaneRegion {
  public:
    explicit PlaneRegion(const Vec3d& origin) : origin_(origin) {}
    void add(const PointCloud& cloud, std::span<const std::uint32_t> indices);
    /// Least-squares plane; the normal's sign is that of `like`. With fewer than 3 points `like`
    /// itself.
    void fit(const Vec3d& like);

    std::size_t count() const { return count_; }
    const Vec3d& normal() const { return normal_; }
    const Vec3d& center() const { return center_; }
    /// Root mean square distance of the points from the plane.
    double roughness() const { return roughness_; }
    double height(const Vec3d& point) const { return normal_.dot(point - center_); }

  private:
    Vec3d origin_;
    Vec3d sum_ = Vec3d::Zero();
    Mat3d squares_ = Mat3d::Zero();
    std::size_t count_ = 0;
    Vec3d normal_ = Vec3d::UnitZ();
    Vec3d center_ = Vec3d::Zero();
    double roughness_ = 0.0;
};

/// The angle by which the surface through the points turns from one side of them to the other,
/// radians, from the paraboloid that fits them; 0 where noise could have made it.
double bend_of(const PointCloud& cloud, std::span<const std::uint32_t> indices,
               const PlaneRegion& plane);

}  // namespace ostraka
