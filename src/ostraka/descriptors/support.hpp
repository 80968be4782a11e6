// SPDX-License-Identifier: Apache-2.0
// Private to this module: the points around a keypoint, as columns relative to it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/exact_sum.hpp"

namespace ostraka {

struct Support {
    std::size_t count = 0;
    std::vector<float> x, y, z;       // offset from the keypoint, cloud's axes and unit
    std::vector<float> distance;      // length of the offset
    std::vector<float> nx, ny, nz;    // normals; empty if not asked for
    std::vector<std::uint32_t> list;  // memory of searches

    void resize(std::size_t points, bool with_normals) {
        count = points;
        if (x.size() < points) {
            for (auto* column : {&x, &y, &z, &distance}) column->resize(points);
        }
        if (with_normals && nx.size() < points) {
            for (auto* column : {&nx, &ny, &nz}) column->resize(points);
        }
    }
};

/// Fills the support from the points at index_of(0), ..., index_of(count - 1).
template <class IndexOf>
void gather(const PointCloud& cloud, const Vec3f& keypoint, std::size_t count, bool with_normals,
            const IndexOf& index_of, Support& support) {
    support.resize(count, with_normals);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3f& point = cloud.points[index_of(i)];
        const float x = point.x() - keypoint.x();
        const float y = point.y() - keypoint.y();
        const float z = point.z() - keypoint.z();
        support.x[i] = x;
        support.y[i] = y;
        support.z[i] = z;
        support.distance[i] = std::sqrt(x * x + y * y + z * z);
    }
    if (!with_normals) return;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3f& normal = cloud.normals[index_of(i)];
        support.nx[i] = normal.x();
        support.ny[i] = normal.y();
        support.nz[i] = normal.z();
    }
}

/// The frame of a keypoint without one.
inline Mat3f no_frame() {
    return Mat3f::Constant(std::numeric_limits<float>::quiet_NaN());
}

/// Center and radius of a whole piece as support.
struct WholeSupport {
    Vec3f center;
    float radius =
        0.0F;  ///< 1.0001 times the largest distance, so that the farthest point is inside
};

inline WholeSupport whole_support(std::span<const Vec3f> points) {
    const Vec3d center = exact_centroid(points);
    return {center.cast<float>(), static_cast<float>(1.0001 * largest_distance(points, center))};
}

}  // namespace ostraka
