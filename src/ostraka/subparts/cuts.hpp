// SPDX-License-Identifier: Apache-2.0
// Cuts a partial view as an occluder would (method, 2.3 and 2.4), as sets of indices into its
// cloud.
#pragma once

#include <array>
#include <vector>

#include "ostraka/cloud/principal_frame.hpp"

namespace ostraka {

struct CutSettings {
    int directions =
        26;  ///< 6 (plus and minus each axis), 14 (and the corners) or 26 (and the edges)
    std::vector<double> fractions = {0.35, 0.5, 0.65,
                                     0.8};  ///< of the length along the direction that stay
    double cluster_tolerance = 0.0;         ///< distance that joins points, in the cloud's unit
    std::size_t min_points = 60;            ///< a smaller subpart is dropped
    double min_share = 0.1;                 ///< of its view's points; a smaller subpart is dropped
};

/// One cut: what stays of a view, and how it was made.
struct Subpart {
    int direction = -1;                  ///< index into cut_directions()
    int fraction = -1;                   ///< index into CutSettings::fractions
    std::vector<std::uint32_t> indices;  ///< ascending, into the view's cloud
};

struct CutResult {
    std::vector<Subpart> subparts;    ///< by direction, then fraction
    std::size_t made = 0;             ///< cuts made: directions times fractions
    std::size_t dropped_by_size = 0;  ///< their largest cluster was too small
};

/// Unit vectors in the coordinates of the principal frame. @param count  6, 14 or 26.
/// @throws InvalidInput for any other count.
std::vector<Vec3d> cut_directions(int count);

/// Indices of the points in the lower `fraction` of the cloud's extent along `direction`.
/// @param direction  unit vector in the cloud's frame.
std::vector<std::uint32_t> cut_below(const PointCloud& cloud, const Vec3d& direction,
                                     double fraction);

/// All cuts of a view along its principal frame: the largest cluster of each, if it is large
/// enough.
CutResult cut_view(const PointCloud& cloud, const PrincipalFrame& frame,
                   const CutSettings& settings);

}  // namespace ostraka
