// SPDX-License-Identifier: Apache-2.0
// The surface of an object that is given as points: a merged scan without faces.
// Hoppe, DeRose, Duchamp, McDonald, Stuetzle. Surface Reconstruction from Unorganized Points. 1992.
// Curless, Levoy. A Volumetric Method for Building Complex Models from Range Images. 1996.
// Departs from the papers:
// - The distance field is the mean of the distances to the planes of all near points, weighted by
//   a Gaussian of the distance (Shen, O'Brien, Shewchuk. Interpolating and Approximating Implicit
//   Surfaces from Polygon Soup. 2004), not that of the nearest point alone: noise averages out.
// - Its zero set is meshed by surface nets (Gibson. Constrained Elastic Surface Nets. 1998), whose
//   vertices are then moved onto it.
// - Where there are no points the surface ends. The end is where the mean of the near points lies
//   aside (Adamson, Alexa. Approximating Bounded, Non-orientable Surfaces from Points. 2004), which
//   closes the small gaps of uneven points and doesn't let edges grow.
#pragma once

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

struct CloudSurfaceSettings {
    double voxel = 1.0;      ///< side of a cell of the grid, in spacings; 0.5 to 2
    double smoothing = 1.5;  ///< radius of the weights, in spacings of the points around; 1 to 2
    double open_edge = 0.8;  ///< how far the mean of the near points may lie aside, in radii of the
                             ///< weights: 0.56 at a straight edge of an open surface
    int most_across = 400;   ///< spacings in the longest side; a denser cloud is resampled
};

struct CloudSurface {
    TriangleMesh mesh;       ///< repaired; wound counter-clockwise from outside; open where there
                             ///< are no points
    double spacing = 0.0;    ///< median distance of the points that were used, in the cloud's unit:
                             ///< 1 / sqrt(points per area)
    std::size_t points = 0;  ///< used: without invalid, repeated and stray ones, maybe resampled
};

/// Rebuilds the surface that the points were taken from. Walls and slits from about 2 spacings
/// stay apart; gaps of up to about 3 spacings are closed; noise of half a spacing is smoothed, and
/// where it is larger the points are resampled first, up to about three times as coarsely.
/// @param cloud  the whole object, seen from all around, any frame and unit. Normals are estimated
///               where there are none; if less than nine in ten are on one side of their surface
///               their signs are found anew (orient_normals()).
/// @return the same for any number of threads.
/// @throws InvalidInput if fewer than 50 points are usable, if they lie in one plane or on a line,
///         or if they span too much for their spacing.
CloudSurface rebuild_surface(const PointCloud& cloud, const CloudSurfaceSettings& settings = {});

}  // namespace ostraka
