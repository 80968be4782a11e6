// SPDX-License-Identifier: Apache-2.0
// Spin images: how many points lie at which distance from the keypoint's normal, and how high.
// Johnson, Hebert. Using Spin Images for Efficient Object Recognition in Cluttered 3D Scenes. PAMI
// 21(5), 1999. As PCL 1.13, also where it departs from the paper: the image has width + 1 distances
// and 2 width + 1 heights, it sums to 1, and normals that point the other way count as alike.
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/local_descriptor.hpp"

namespace ostraka {

struct SpinImageSettings {
    float radius = 0.0F;  ///< of the ball that holds the image's cylinder, in the points' unit; the
                          ///< cylinder's radius and half height are radius / sqrt(2); must be set
    int width = 8;        ///< bins along the distance, and along half of the height; 1 to 64
    float support_cosine = 0.0F;  ///< least |cosine| between a point's normal and the keypoint's
                                  ///< for it to count; 0 counts all (the paper: 0.5)
};

/// Floats in a row: (width + 1) x (2 width + 1), 153 by default.
constexpr std::size_t spin_image_length(const SpinImageSettings& settings) {
    const auto width = static_cast<std::size_t>(settings.width < 0 ? 0 : settings.width);
    return (width + 1) * (2 * width + 1);
}

/// @param cloud  finite points with unit normals; with a support_cosine above 0 a NaN normal's
///               point doesn't count.
/// @param keypoints  finite, in the cloud's frame; need not be points of the cloud.
/// @param axes  one unit vector for each keypoint, in the cloud's frame.
/// @return rows of spin_image_length() floats, non-negative, sum 1; row-major, distance from the
///         axis (from 0 up) by height (from below to above the tangent plane). A row of 0 where no
///         other point counts or the axis is not finite. No frames. The same bits for any order of
///         the points and any number of threads.
/// @throws InvalidInput if normals are missing, a point is not finite, the numbers of axes and
///         keypoints differ, or a setting is out of range.
LocalDescriptors describe_spin_images(const PointCloud& cloud, std::span<const Vec3f> keypoints,
                                      std::span<const Vec3f> axes,
                                      const SpinImageSettings& settings);

/// The same with the arguments of the other local descriptors. The search is its own, so the tree
/// is only checked: it must be over cloud.points.
LocalDescriptors describe_spin_images(const PointCloud& cloud, const KdTree& tree,
                                      std::span<const Vec3f> keypoints, std::span<const Vec3f> axes,
                                      const SpinImageSettings& settings);

/// The same with the normal of the point nearest to each keypoint as its axis.
/// @param tree  over cloud.points.
LocalDescriptors describe_spin_images(const PointCloud& cloud, const KdTree& tree,
                                      std::span<const Vec3f> keypoints,
                                      const SpinImageSettings& settings);

}  // namespace ostraka
