// SPDX-License-Identifier: Apache-2.0
// Private to mesh: samples of a surface, and how well a moved copy of them lies on the surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Evenly spread samples in a frame of their own: the mean of the points is the origin, the
/// model's diameter is 1. All lengths below are in diameters.
class SymmetrySurface {
  public:
    /// @param points, normals  equally many, finite; more than one for each sample wanted.
    /// @param spacing  of the samples, in diameters: a guess.
    SymmetrySurface(std::span<const Vec3f> points, std::span<const Vec3f> normals, double diameter,
                    double tolerance, int samples, double spacing);

    std::span<const Vec3f> points() const { return points_; }
    std::span<const Vec3f> normals() const { return normals_; }
    /// The origin of the frame, in the frame and unit of the points given.
    const Vec3d& origin() const { return origin_; }
    std::size_t size() const { return points_.size(); }

    /// Whether all but `outliers` of the first `count` samples, moved, lie on the surface to
    /// `tolerance`, which is at most that of the constructor plus kLooseness.
    bool lies_on_itself(const Pose& motion, std::size_t count, double tolerance,
                        double outliers) const;

    /// The motion near `guess` that maps the first `count` samples best onto the surface
    /// (point-to-plane registration); a direction in which nothing holds it isn't moved along.
    Pose refined(const Pose& guess, std::size_t count) const;

    static constexpr double kLooseness = 0.025;

  private:
    struct Sample {
        float x, y, z;     // position
        float nx, ny, nz;  // normal
    };

    void thin(std::span<const Vec3f> points, std::span<const Vec3f> normals, double scale,
              int samples);
    void sort_into_cells();
    template <class Visit>
    void for_neighbors(const Vec3f& point, const float& bound, const Visit& visit) const;
    bool fits(const Vec3f& point, const Vec3f& normal, float tolerance) const;
    const Sample* closest(const Vec3f& point, const Vec3f& normal) const;

    Vec3d origin_ = Vec3d::Zero();
    std::vector<Vec3f> points_;  // in an order without pattern: the first k are spread, too
    std::vector<Vec3f> normals_;
    double spacing_ = 0.0;   // no two samples that face the same way are closer
    double covering_ = 0.0;  // no point of the surface is farther from a sample
    double tolerance_;
    float cell_ = 0.0F;
    Vec3f corner_ = Vec3f::Zero();
    std::array<int, 3> cells_{};
    std::vector<std::uint32_t> starts_;
    std::vector<Sample> sorted_;
};

}  // namespace ostraka
