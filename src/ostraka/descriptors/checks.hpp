// SPDX-License-Identifier: Apache-2.0
// Private to this module: what every descriptor demands of its input.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <string_view>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

/// Points farther than this from the origin would overflow float products.
inline constexpr float kLargestCoordinate = 1e12F;

/// Whether a point can be computed with: finite, and near enough to the origin.
inline bool usable(const Vec3f& point) {
    return std::abs(point.x()) <= kLargestCoordinate && std::abs(point.y()) <= kLargestCoordinate &&
           std::abs(point.z()) <= kLargestCoordinate;
}

/// @throws InvalidInput if there are no points, or a point is not finite or absurdly far.
inline void require_points(const PointCloud& cloud, std::string_view descriptor) {
    check(cloud);
    if (cloud.empty()) throw InvalidInput(fmt::format("{}: the cloud has no points", descriptor));
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (usable(cloud.points[i])) continue;
        const Vec3f& point = cloud.points[i];
        throw InvalidInput(fmt::format("{}: point {} is not finite or too far: {:g} {:g} {:g}",
                                       descriptor, i, point.x(), point.y(), point.z()));
    }
}

/// @throws InvalidInput if the cloud has no normals.
inline void require_normals(const PointCloud& cloud, std::string_view descriptor) {
    if (cloud.normals.empty()) {
        throw InvalidInput(fmt::format("{}: the cloud has no normals", descriptor));
    }
}

/// @throws InvalidInput if the tree can't be over the cloud, a keypoint is not finite, or the
/// radius
///         is not positive.
inline void require_support(const PointCloud& cloud, const KdTree& tree,
                            std::span<const Vec3f> keypoints, float radius,
                            std::string_view descriptor) {
    if (tree.size() != cloud.size()) {
        throw InvalidInput(fmt::format("{}: a tree over {} points for a cloud of {}", descriptor,
                                       tree.size(), cloud.size()));
    }
    if (!(radius > 0.0F) || !(radius <= kLargestCoordinate)) {
        throw InvalidInput(fmt::format("{}: radius {:g}, must be positive", descriptor, radius));
    }
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
        if (usable(keypoints[i])) continue;
        throw InvalidInput(fmt::format("{}: keypoint {} is not finite or too far", descriptor, i));
    }
}

}  // namespace ostraka
