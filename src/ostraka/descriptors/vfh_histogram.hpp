// SPDX-License-Identifier: Apache-2.0
// Private to this module: VFH's histograms around any center, for several centers of one cloud.
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

/// What all points are compared with.
struct VfhCenter {
    Vec3f point = Vec3f::Zero();   ///< in the cloud's frame and unit
    Vec3f normal = Vec3f::Zero();  ///< unit length, or a mean of unit normals
};

struct VfhBins {
    bool normalize = false;  ///< blocks sum to 100 instead of the number of points
    bool distances = false;  ///< the fourth block: 45 bins of the distance over the largest one
};

class VfhHistogram {
  public:
    /// @param cloud  finite points with normals; copied.
    explicit VfhHistogram(const PointCloud& cloud);

    /// @param row  kVfhLength floats, replaced: 45 angles, 45 cosines, 45 tilts, 45 distances (or
    ///             0), 128 cosines to the viewpoint.
    void describe(const VfhCenter& center, const VfhBins& bins, std::span<float> row) const;

  private:
    std::vector<float> px_, py_, pz_, nx_, ny_, nz_;
    Vec3f viewpoint_;
};

/// Mean point and mean of the finite normals (not brought to unit length), as PCL's VFH takes them.
VfhCenter whole_center(const PointCloud& cloud);

}  // namespace ostraka
