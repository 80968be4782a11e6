// SPDX-License-Identifier: Apache-2.0
// Clouds of known shape for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "ostraka/base/random.hpp"
#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka::test_clouds {

/// `count` points, uniform in a box of side 2 * half around `center`.
inline std::vector<Vec3f> in_box(std::size_t count, std::uint64_t seed,
                                 const Vec3d& half = Vec3d::Ones(),
                                 const Vec3d& center = Vec3d::Zero()) {
    Random random(seed);
    std::vector<Vec3f> points;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        points.push_back(Vec3d(center + half.cwiseProduct(p)).cast<float>());
    }
    return points;
}

/// A square lattice of n x n points, `spacing` apart, in the plane z = 0.
inline std::vector<Vec3f> lattice(int n, float spacing) {
    std::vector<Vec3f> points;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            points.emplace_back(static_cast<float>(i) * spacing, static_cast<float>(j) * spacing,
                                0.0F);
        }
    }
    return points;
}

/// Points on the sphere around the origin, with outward normals.
inline PointCloud sphere(std::size_t count, double radius, std::uint64_t seed = 1) {
    Random random(seed);
    PointCloud cloud;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d direction = random.direction();
        cloud.points.push_back(Vec3d(radius * direction).cast<float>());
        cloud.normals.push_back(direction.cast<float>());
    }
    return cloud;
}

/// A random rigid motion with a shift of up to `reach` along each axis.
inline Pose random_pose(std::uint64_t seed, double reach = 3.0) {
    Random random(seed);
    Pose pose = Pose::Identity();
    pose.linear() = random.rotation();
    for (int axis = 0; axis < 3; ++axis) pose.translation()[axis] = random.uniform(-reach, reach);
    return pose;
}

inline Vec3f nowhere() {
    return Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
}

}  // namespace ostraka::test_clouds
