// SPDX-License-Identifier: Apache-2.0
// Smooth regions of a piece: what CVFH and OUR-CVFH describe one by one.
// Aldoma, Vincze, Blodow, Gossow, Gedikli, Rusu, Bradski. CAD-Model Recognition and 6DOF Pose
// Estimation Using 3D Cues. ICCV Workshops 2011.
// As PCL 1.13: points of high curvature are left out, the normals of the rest are fitted anew among
// themselves, and neighbors whose normals agree are joined. From PCL: regions come largest first;
// equal normals always join (PCL takes the arc cosine of a product that rounding may bring above 1,
// and then doesn't); a point without a plane around it is in no region; the default radii follow
// the density instead of PCL's 15 mm.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

struct CvfhRegionSettings {
    float normal_radius = 0.0F;   ///< around a point, for its plane; cloud's unit; 0: 3 mesh
                                  ///< resolutions
    float tolerance = 0.0F;       ///< distance below which neighbors join, cloud's unit; 0: as
                                  ///< normal_radius
    float max_angle = 0.125F;     ///< radians between the normals of neighbors that join
    float max_curvature = 0.03F;  ///< surface variation above which a point is left out; 0 to 1/3
    std::size_t min_points = 50;  ///< smaller regions are left out
};

struct SmoothRegion {
    std::vector<std::uint32_t> points;  ///< indices into the cloud, ascending; at least 1
    Vec3f centroid = Vec3f::Zero();     ///< mean of the points, in the cloud's frame and unit
    Vec3f normal = Vec3f::Zero();       ///< direction of the mean fitted normal, unit length
};

/// The smooth regions of a piece.
/// @param cloud  finite points; cloud.viewpoint tells which side normals are on; cloud.normals are
///               not used.
/// @param curvatures  one surface variation for each point (NaN: keep the point), or empty: they
///                    are computed by surface_variations() within the normal radius.
/// @param refinement  afterwards points whose normal is farther than refinement * max_angle from
///                    their region's mean normal leave the region; 0: none leaves.
/// @return largest first, ties by the smallest index; none if the cloud is too small or rough.
/// @throws InvalidInput if a point is not finite, the number of curvatures is wrong, or a setting
///         is negative.
std::vector<SmoothRegion> smooth_regions(const PointCloud& cloud,
                                         std::span<const float> curvatures = {},
                                         const CvfhRegionSettings& settings = {},
                                         float refinement = 0.0F);

/// Share of the least variance in the scatter of the points closer than `radius`: 0 on a plane, 1/3
/// where points are spread evenly. Pauly, Gross, Kobbelt. Efficient Simplification of Point-Sampled
/// Surfaces. IEEE Visualization 2002. PCL calls it curvature.
/// @param points  finite. @param radius  in their unit, positive.
/// @return one value for each point, 0 to 1/3; 0 with fewer than 3 points around.
std::vector<float> surface_variations(std::span<const Vec3f> points, float radius);

}  // namespace ostraka
