// SPDX-License-Identifier: Apache-2.0
// Private to this module: what local descriptors with their own search demand of their input.
#pragma once

#include "ostraka/descriptors/checks.hpp"

namespace ostraka {

/// @throws InvalidInput if the radius is not positive or absurdly large.
inline void require_radius(float radius, std::string_view descriptor) {
    if (radius > 0.0F && radius <= kLargestCoordinate) return;
    throw InvalidInput(fmt::format("{}: radius {:g}, must be positive", descriptor, radius));
}

/// @throws InvalidInput if a keypoint is not finite or absurdly far.
inline void require_keypoints(std::span<const Vec3f> keypoints, std::string_view descriptor) {
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
        if (usable(keypoints[i])) continue;
        throw InvalidInput(fmt::format("{}: keypoint {} is not finite or too far", descriptor, i));
    }
}

/// @throws InvalidInput if the tree can't be over the cloud.
inline void require_tree(const PointCloud& cloud, const KdTree& tree, std::string_view descriptor) {
    if (tree.size() == cloud.size()) return;
    throw InvalidInput(fmt::format("{}: a tree over {} points for a cloud of {}", descriptor,
                                   tree.size(), cloud.size()));
}

/// @throws InvalidInput if a point is not finite or normals are missing. An empty cloud is allowed.
inline void require_surfels(const PointCloud& cloud, std::string_view descriptor) {
    if (cloud.empty()) {
        check(cloud);
        return;
    }
    require_points(cloud, descriptor);
    require_normals(cloud, descriptor);
}

}  // namespace ostraka
