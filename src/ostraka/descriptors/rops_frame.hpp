// SPDX-License-Identifier: Apache-2.0
// Private to this module: the local reference frame of RoPS, from the triangles around a keypoint.
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/descriptors/triangulation.hpp"

namespace ostraka {

/// What a triangle adds to a frame, independent of the keypoint.
struct TriangleMoments {
    Vec3d center;  ///< mean of the corners
    double area;   ///< twice the area
    /// sum of (corner - center)(corner - center)^T: xx, xy, xz, yy, yz, zz
    std::array<double, 6> spread;
};

/// Which triangles a keypoint has met already.
class TriangleMarks {
  public:
    explicit TriangleMarks(std::size_t triangles) : marks_(triangles, 0) {}
    void start() { ++round_; }
    /// Whether this is the first time since start().
    bool first_time(std::uint32_t triangle) {
        const bool first = marks_[triangle] != round_;
        marks_[triangle] = round_;
        return first;
    }

  private:
    std::vector<std::uint32_t> marks_;
    std::uint32_t round_ = 0;
};

/// A triangulated cloud, prepared for many keypoints. The points must outlive it.
class RopsSurface {
  public:
    RopsSurface(std::span<const Vec3f> points, std::span<const IndexTriangle> triangles);

    /// The frame from all triangles with a corner among the neighbors.
    /// @return R_local_cloud; NaN if they have no area.
    Mat3f local_frame(const Vec3f& keypoint, float radius, std::span<const Neighbor> neighbors,
                      TriangleMarks& marks) const;

  private:
    std::vector<TriangleMoments> moments_;
    std::vector<std::uint32_t> starts_;     // points + 1 offsets into triangles_
    std::vector<std::uint32_t> triangles_;  // of each point
};

/// The frame from all triangles.
Mat3f whole_frame(std::span<const Vec3f> points, std::span<const IndexTriangle> triangles,
                  const Vec3f& center, float radius);

}  // namespace ostraka
