// SPDX-License-Identifier: Apache-2.0
// What the tests of local descriptors share: odd clouds, and ways to change a cloud that a
// descriptor must not notice.
#pragma once

#include <algorithm>
#include <numeric>

#include "descriptors/shapes.hpp"
#include "ostraka/base/random.hpp"

namespace ostraka::shapes {

/// Every `step`-th point.
inline std::vector<Vec3f> some_keypoints(const PointCloud& cloud, std::size_t step) {
    std::vector<Vec3f> keypoints;
    for (std::size_t i = 0; i < cloud.size(); i += step) keypoints.push_back(cloud.points[i]);
    return keypoints;
}

/// The same points in another order.
inline PointCloud shuffled(const PointCloud& cloud, std::uint64_t seed = 5) {
    std::vector<std::uint32_t> order(cloud.size());
    std::iota(order.begin(), order.end(), 0U);
    Random random(seed);
    for (std::uint32_t i = static_cast<std::uint32_t>(order.size()); i > 1; --i) {
        std::swap(order[i - 1], order[random.below(i)]);
    }
    return select(cloud, order);
}

/// Some rigid motion.
inline Pose some_motion() {
    Pose T_b_a = Pose::Identity();
    T_b_a.linear() = Random(8).rotation();
    T_b_a.translation() = Vec3d(5.0, 6.0, -7.0);
    return T_b_a;
}

/// count x count points of a plane with spacing 1, slightly irregular, normals along z.
inline PointCloud plane(int count, std::uint64_t seed = 4) {
    PointCloud cloud;
    Random random(seed);
    for (int y = 0; y < count; ++y) {
        for (int x = 0; x < count; ++x) {
            cloud.points.emplace_back(static_cast<float>(x + 0.3 * random.uniform()),
                                      static_cast<float>(y + 0.3 * random.uniform()), 0.0F);
            cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
        }
    }
    cloud.viewpoint = Vec3f(0.0F, 0.0F, 100.0F);
    return cloud;
}

/// Clouds that have little in common with a surface.
inline std::vector<PointCloud> odd_clouds() {
    std::vector<PointCloud> clouds;
    PointCloud line;
    PointCloud duplicates;
    for (int i = 0; i < 40; ++i) {
        line.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
        line.normals.emplace_back(0.0F, 0.0F, 1.0F);
        duplicates.points.emplace_back(1.0F, 2.0F, 3.0F);
        duplicates.normals.emplace_back(i % 2 == 0 ? 1.0F : 0.0F, i % 2 == 0 ? 0.0F : 1.0F, 0.0F);
    }
    PointCloud bare = bumpy_ellipsoid(300);
    for (std::size_t i = 0; i < bare.size(); i += 2) {
        bare.normals[i] = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
    }
    PointCloud none = bare;
    none.normals.assign(bare.size(), Vec3f::Constant(std::numeric_limits<float>::quiet_NaN()));
    const std::vector<std::uint32_t> three = {0, 1, 2};
    clouds.push_back(line);
    clouds.push_back(duplicates);
    clouds.push_back(select(bumpy_ellipsoid(3), three));
    clouds.push_back(bare);
    clouds.push_back(none);
    clouds.push_back(plane(15));
    return clouds;
}

/// The rows of `b` that differ from those of `a` by more than `tolerance` (relative L1).
inline std::size_t different_rows(std::span<const float> a, std::span<const float> b,
                                  std::size_t length, double tolerance) {
    std::size_t different = 0;
    for (std::size_t i = 0; i + length <= a.size(); i += length) {
        const bool same = relative_l1(b.subspan(i, length), a.subspan(i, length)) <= tolerance ||
                          std::equal(a.begin() + i, a.begin() + i + length, b.begin() + i);
        if (!same) ++different;
    }
    return different;
}

}  // namespace ostraka::shapes
