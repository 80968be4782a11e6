// SPDX-License-Identifier: Apache-2.0
// The dominant plane of a scan: a table or the floor of a bin.
// Fischler, Bolles. Random Sample Consensus. CACM 24(6), 1981. Seeded; refined by least squares.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

struct PlaneSettings {
    double tolerance = 0.0;  ///< distance from the plane, in the cloud's unit, that counts as on it
    double max_angle = 0.35;  ///< radians between a point's normal and the plane's
    int trials = 500;         ///< random triples tried
    std::uint64_t seed = 0;   ///< same seed, same plane
};

struct Plane {
    Vec3d normal = Vec3d::UnitZ();       ///< unit, toward the viewpoint
    double offset = 0.0;                 ///< normal . x = offset for points x on the plane
    std::vector<std::uint32_t> inliers;  ///< ascending indices
};

/// The plane with the most points near it whose normals agree with it.
/// @param cloud  finite points with normals.
/// @return nothing if no plane has at least `min_inliers` points.
/// @throws InvalidInput if normals are missing or settings.trials is below 1.
std::optional<Plane> find_plane(const PointCloud& cloud, std::size_t min_inliers,
                                const PlaneSettings& settings);

}  // namespace ostraka
