// SPDX-License-Identifier: Apache-2.0
// One side for all normals of a cloud whose sensor positions are unknown: the outside.
// Hoppe, DeRose, Duchamp, McDonald, Stuetzle. Surface Reconstruction from Unorganized Points. 1992.
// Departs from the paper:
// - Two normals are compared without their components along the line between their points. On a
//   smooth surface that changes nothing; over a crease their dot product has no sign and this one
//   has; and between the two sides of a thin wall it is 0, so that the tree doesn't jump there.
// - The paper turns the highest point upward, one point for the whole cloud. Here every smooth
//   patch is asked which of its sides can be seen from far away (as Takayama, Jacobson, Kavan,
//   Sorkine-Hornung. A Simple Method for Correcting Facet Orientations in Polygon Meshes Based on
//   Ray Casting. JCGT 3(4), 2014, ask facets), and only patches without a clear answer follow the
//   tree, in which patches are joined by the sum of all edges between them. So several objects are
//   handled, and one bad edge of the tree can't turn half an object.
#pragma once

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

struct OrientationSettings {
    int neighbors = 8;      ///< of a point in the graph; at least 1
    double smooth = 0.95;   ///< agreement of two normals (1: parallel) that makes one patch of them
    double decisive = 0.5;  ///< |seen outside - seen inside| / all, from which a patch is sure
};

struct OrientationResult {
    std::size_t groups = 0;  ///< connected parts of the graph
    std::size_t unsure = 0;  ///< points in groups both of whose sides are seen alike, such as a
                             ///< lone plane; these keep the side that most of their normals had
    std::size_t turned = 0;  ///< normals that changed their sign
};

/// Turns each normal to the outside of the object that its point belongs to; estimates them first
/// (estimate_normals()) if there are none. Points are those of one or more objects seen from
/// several sides, or all around; a part seen from one side only is turned to its convex side.
/// The result doesn't depend on the signs before, except where `unsure`, nor on the threads.
/// @param cloud  any frame and unit; a point that is NaN is left out. Normals are of unit length;
///               one that is NaN or zero stays so. The viewpoint is not used.
/// @throws InvalidInput if check(cloud) fails or a setting is out of range.
OrientationResult orient_normals(PointCloud& cloud, const OrientationSettings& settings = {});

}  // namespace ostraka
