// SPDX-License-Identifier: Apache-2.0
// Surface normals by plane fitting.
// Hoppe, DeRose, Duchamp, McDonald, Stuetzle. Surface Reconstruction from Unorganized Points. 1992.
#pragma once

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

/// Radius of the neighborhoods in views and scans, in sampling distances of a resampled cloud.
inline constexpr double kNormalRadius = 2.3;

struct NormalSettings {
    int neighbors = 20;  ///< points in each fit, the point itself included; at least 3
};

/// The normal of each point: the direction of least variance of its nearest neighbors, turned
/// toward cloud.viewpoint.
/// @param cloud  all points finite.
/// @return one unit vector per point; NaN where the neighborhood has no unique plane (fewer than 3
///         points, or all on a line).
std::vector<Vec3f> estimate_normals(const PointCloud& cloud, const NormalSettings& settings = {});

/// The same with all points closer than `radius` instead of a number of neighbors: several times
/// faster, and as good on a cloud of even density (see resample()).
/// @param radius  in the cloud's unit, positive; about 2.2 sampling distances hold 15 to 20 points.
std::vector<Vec3f> estimate_normals_within(const PointCloud& cloud, double radius);

}  // namespace ostraka
