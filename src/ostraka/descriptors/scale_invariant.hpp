// SPDX-License-Identifier: Apache-2.0
// Local descriptors of keypoints that bring their own scale (see scale_keypoints.hpp), so that a
// shape and the same shape of another size have the same rows.
// Darom, Keller. Scale-Invariant Features for 3-D Mesh Models. IEEE Transactions on Image
// Processing 21(5), 2012. Details as in the toolbox that the authors published.
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/local_descriptor.hpp"
#include "ostraka/descriptors/scale_keypoints.hpp"

namespace ostraka {

/// Scale-invariant spin image (SISI): a spin image whose cylinder grows with the keypoint's scale.
/// Departs from the toolbox: votes are shared by four bins, as in Johnson and Hebert.
struct SisiSettings {
    float support = 5.0F;  ///< radius and half height of the cylinder, in scales; positive
    int width = 8;         ///< bins along the distance, and along half of the height; 1 to 64
};

/// Floats in a row: (width + 1) x (2 width + 1), 153 by default.
constexpr std::size_t sisi_length(const SisiSettings& settings) {
    const auto width = static_cast<std::size_t>(settings.width < 0 ? 0 : settings.width);
    return (width + 1) * (2 * width + 1);
}

/// @param cloud  finite points with unit normals; points whose normal is NaN or points away from
///               the keypoint's don't count.
/// @return rows of sisi_length() floats, non-negative, sum 1; all 0 where nothing counts or the
///         keypoint has no normal. Row-major: distance from the axis by height. No frames. The same
///         bits for any order of the points and any number of threads.
/// @throws InvalidInput if normals are missing, a point is not finite, a keypoint's index or scale
///         is out of range, or a setting is.
LocalDescriptors describe_sisi(const PointCloud& cloud, std::span<const ScaleKeypoint> keypoints,
                               const SisiSettings& settings = {});

inline constexpr std::size_t kLdSiftLength = 128;

/// Local depth SIFT (LD-SIFT): the surface as a depth image of 21 x 21 pixels along the keypoint's
/// normal, turned upright by its principal direction and described as Lowe's SIFT (4 x 4 squares, 8
/// directions of the depth's gradient). A principal direction has no sign: the descriptors of the
/// image and of the image upside down are added.
/// Departs from the toolbox: the principal direction is sought within the tangent plane, where the
/// toolbox projects that of space onto it; only triangles within the ball around the image are
/// drawn; the row's norm is 1.
struct LdSiftSettings {
    float support = 5.0F;  ///< half the image's side, in scales; positive
};

/// @param triangles  of the surface, indices into cloud.points.
/// @return rows of kLdSiftLength floats, non-negative, L2 norm 1; all 0 where the image is flat or
///         undefined. Frames: y along the principal direction, z the normal; either may stand for
///         the other that is turned by half around z; NaN where undefined.
/// @throws InvalidInput as describe_sisi(), or if a triangle's index is out of range.
LocalDescriptors describe_ld_sift(const PointCloud& cloud, std::span<const IndexTriangle> triangles,
                                  std::span<const ScaleKeypoint> keypoints,
                                  const LdSiftSettings& settings = {});

}  // namespace ostraka
