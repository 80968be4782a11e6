// SPDX-License-Identifier: Apache-2.0
// Private to this module: the supports of many keypoints in one cloud, all of one radius. The
// points, with their normals, are copied once in the order of coarse cells (see cell_order.hpp), so
// that a search is a vectorized sweep over some runs of columns; no tree, no sorting by distance.
#pragma once

#include <string_view>

#include "ostraka/descriptors/cell_order.hpp"
#include "ostraka/descriptors/support.hpp"

namespace ostraka {

/// @throws InvalidInput if the cloud's columns or points are unusable, a keypoint is not finite, or
///         the radius is not positive. A cloud without points is fine.
void require_search(const PointCloud& cloud, std::span<const Vec3f> keypoints, float radius,
                    std::string_view descriptor);

/// Searches are const and safe from many threads.
class Neighborhoods {
  public:
    /// @param radius  of the searches, in the cloud's unit, positive.
    /// @param with_normals  whether supports get the normals of the points, too.
    Neighborhoods(const PointCloud& cloud, float radius, bool with_normals);

    /// Fills the support with the points closer than the radius. They come in an order that depends
    /// on the order of the cloud's points.
    void find(const Vec3f& keypoint, Support& support) const;

  private:
    float radius_;
    CellOrder order_;
    std::vector<float> x_, y_, z_;     // in the order of the cells
    std::vector<float> nx_, ny_, nz_;  // likewise; empty without normals
};

}  // namespace ostraka
