// SPDX-License-Identifier: Apache-2.0
// Private to this module: the points of a piece in GASD's frame.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "ostraka/descriptors/gasd.hpp"

namespace ostraka {

struct AlignedPoints {
    std::vector<Vec3f> points;  ///< relative to the centroid, along the frame's axes
    float farthest = 0.0F;      ///< largest distance to the centroid
    float largest = 0.0F;       ///< largest coordinate along any axis
};

inline AlignedPoints align(const PointCloud& cloud, const GasdFrame& frame) {
    const Mat3d& R = frame.R_aligned_cloud;
    AlignedPoints aligned;
    aligned.points.resize(cloud.size());
    float farthest = 0.0F;
    float largest = 0.0F;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const double dx = cloud.points[i].x() - frame.centroid.x();
        const double dy = cloud.points[i].y() - frame.centroid.y();
        const double dz = cloud.points[i].z() - frame.centroid.z();
        const auto x = static_cast<float>(R(0, 0) * dx + R(0, 1) * dy + R(0, 2) * dz);
        const auto y = static_cast<float>(R(1, 0) * dx + R(1, 1) * dy + R(1, 2) * dz);
        const auto z = static_cast<float>(R(2, 0) * dx + R(2, 1) * dy + R(2, 2) * dz);
        aligned.points[i] = Vec3f(x, y, z);
        farthest = std::max(farthest, (x * x + z * z) + y * y);
        largest = std::max({largest, std::abs(x), std::abs(y), std::abs(z)});
    }
    aligned.farthest = std::sqrt(farthest);
    aligned.largest = largest;
    return aligned;
}

}  // namespace ostraka
