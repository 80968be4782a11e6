// SPDX-License-Identifier: Apache-2.0
// Private to this module: the local reference frame of RoPS, from the triangles around a keypoint.
#pragma once

#include <span>
#include <vector>

#include "ostraka/descriptors/cell_order.hpp"
#include "ostraka/descriptors/triangulation.hpp"

namespace ostraka {

/// What triangles add to a frame, independent of the keypoint, as columns; and their corners.
/// Columns are padded, so that vectors may read beyond their end.
struct TriangleColumns {
    TriangleColumns(std::size_t triangles, bool with_corners);
    void set(std::size_t at, std::span<const Vec3f> points, const IndexTriangle& triangle);

    std::vector<double> x, y, z;                // mean of the corners
    std::vector<double> area;                   // twice the area
    std::array<std::vector<double>, 6> spread;  // sum of (corner - mean)(corner - mean)^T: xx, xy,
                                                // xz, yy, yz, zz
    std::array<std::vector<float>, 9> corner;   // x, y, z of the first, second and third; or empty
};

/// A triangulated cloud, prepared for many keypoints.
class RopsSurface {
  public:
    /// @param radius  of the supports.
    RopsSurface(std::span<const Vec3f> points, std::span<const IndexTriangle> triangles,
                float radius);

    /// The frame from all triangles with a corner closer to the keypoint than the radius.
    /// @return R_local_cloud; NaN if they have no area.
    Mat3f local_frame(const Vec3f& keypoint) const;

  private:
    RopsSurface(std::span<const Vec3f> points, std::span<const IndexTriangle> triangles,
                float radius, std::span<const Vec3f> centers);

    float radius_;
    float longest_arm_ = 0.0F;  // from a triangle's mean to its corner
    CellOrder order_;           // of the means
    TriangleColumns columns_;   // in that order
};

/// The frame from all triangles.
Mat3f whole_frame(std::span<const Vec3f> points, std::span<const IndexTriangle> triangles,
                  const Vec3f& center, float radius);

}  // namespace ostraka
