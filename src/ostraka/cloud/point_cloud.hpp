// SPDX-License-Identifier: Apache-2.0
// A point cloud: what a depth sensor, a view or a piece of either holds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Points with optional normals, colors and grid. Invariants (see check()): `normals` and `colors`
/// are empty or as long as `points`; `width * height` is 0 or the number of points.
struct PointCloud {
    std::vector<Vec3f> points;   ///< any frame and unit; a NaN coordinate marks "no return"
    std::vector<Vec3f> normals;  ///< unit length, toward the sensor; NaN where undefined
    std::vector<Color> colors;   ///< 8-bit red, green, blue
    int width = 0;               ///< columns of an organized cloud (row-major); 0 if unorganized
    int height = 0;              ///< rows of an organized cloud; 0 if unorganized
    Vec3f viewpoint = Vec3f::Zero();  ///< the sensor's position, in the frame of the points

    std::size_t size() const { return points.size(); }
    bool empty() const { return points.empty(); }
    bool organized() const { return width > 0 && height > 0; }
};

/// @throws InvalidInput if an invariant of PointCloud is broken.
void check(const PointCloud& cloud);

/// The points at `indices`, in that order, with their normals and colors; unorganized, same
/// viewpoint.
PointCloud select(const PointCloud& cloud, std::span<const std::uint32_t> indices);

/// Without points (or, where normals are present, normals) that are not finite; unorganized.
PointCloud remove_invalid(const PointCloud& cloud);

/// The cloud moved by T_new_old: points, normals and viewpoint.
PointCloud transformed(const PointCloud& cloud, const Pose& T_new_old);

/// The cloud with every length multiplied by `factor`: points and viewpoint.
PointCloud scaled(PointCloud cloud, double factor);

/// Mean of the points (double sums). @param cloud at least 1 point, all finite.
Vec3d centroid(std::span<const Vec3f> points);

}  // namespace ostraka
