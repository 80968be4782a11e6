// SPDX-License-Identifier: Apache-2.0
// How far a flat surface extends around each place on it: boxes side by side are no wall.
#pragma once

#include <vector>

#include "ostraka/segmentation/plane_pieces.hpp"

namespace ostraka {

/// The longest straight line through each place of a flat piece of a scan that stays on the
/// surface, or behind what is in front of it. It ends where rays go through the plane or nothing is
/// measured, at gaps of about three pixels, and where neighbors only touch. On a face of a model it
/// is never longer than the model's diameter.
class SurfaceExtents {
  public:
    /// @param scan   finite points from one viewpoint, which is set.
    /// @param pitch  distance between neighboring points across the line of sight, positive.
    /// @param slack  distance from the plane that counts as on it.
    SurfaceExtents(const PlanePiece& piece, const PointCloud& scan, double pitch, double slack);

    /// Of the longest line within about three pixels of a place near the plane, scan's
    /// unit; 0 where no surface is.
    double at(const Vec3d& place) const;

  private:
    int column(double x) const;
    int row(double y) const;

    Pose T_piece_cloud_;
    Vec2d half_;
    double side_;  // of a cell
    int width_ = 0;
    int height_ = 0;
    std::vector<float> lengths_;  // row by row
};

}  // namespace ostraka
