// SPDX-License-Identifier: Apache-2.0
// Where to compute local descriptors: everywhere evenly, or where the surface is distinctive.
// ISS: Zhong. Intrinsic Shape Signatures: A Shape Descriptor for 3D Object Recognition. ICCV
// Workshops 2009. As PCL 1.13 (without its border search), also where it departs from the paper:
// neighbors weigh the same and the scatter is not divided by their number; `paper_weights` gives
// the paper's way. From PCL: surfaces that are flat up to rounding have no keypoints (PCL finds
// some, by chance).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

struct IssSettings {
    float salient_radius = 0.0F;  ///< of the neighborhood that is judged, in the points' unit; must
                                  ///< be set; about 6 mesh resolutions
    float non_max_radius = 0.0F;  ///< within which only the most salient point stays, in the
                                  ///< points' unit; must be set; about 4 mesh resolutions
    double gamma_21 = 0.975;      ///< largest ratio of second to first eigenvalue
    double gamma_32 = 0.975;      ///< largest ratio of third to second eigenvalue
    int min_neighbors = 5;        ///< fewest points within either radius, the point included
    bool paper_weights = false;   ///< as the paper: a neighbor weighs 1 / its own number of
                                  ///< neighbors, against uneven density
};

/// Points where the surface bends in all directions: the third eigenvalue of the scatter of the
/// points around them is the largest far and wide, and no two eigenvalues are equal, so that a
/// local frame is stable there.
/// @param points  finite, any unit.
/// @return indices into `points`, ascending. The same points for any order they are given in and
/// any
///         number of threads.
/// @throws InvalidInput if a point is not finite or a setting is out of range.
std::vector<std::uint32_t> detect_iss(std::span<const Vec3f> points, const IssSettings& settings);

struct UniformSettings {
    float spacing = 0.0F;  ///< side of a cell, in the points' unit; must be set, positive
};

/// One point for each occupied cell of a grid through the origin: the nearest to the cell's center,
/// as pcl::UniformSampling (which adds 1 to squared distances, so that in small units rounding
/// decides). Unlike resample() it keeps measured points.
/// @param points  finite.
/// @return indices into `points`, ascending; the same points for any order they are given in.
/// @throws InvalidInput if a point is not finite, the spacing is not positive, or a point lies more
///         than 2^30 cells from the origin.
std::vector<std::uint32_t> detect_uniform(std::span<const Vec3f> points,
                                          const UniformSettings& settings);

}  // namespace ostraka
