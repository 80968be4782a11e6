// SPDX-License-Identifier: Apache-2.0
// The turns that map a model's surface onto itself. See docs/symmetry.md.
// Axes are sought as in Martinet, Soler, Holzschuch, Sillion. Accurate Detection of Symmetries in
// 3D Shapes. ACM TOG 25(2), 2006: every axis of a turn is a critical direction of every moment.
// Departs from the paper: moments of normals are used besides those of points; they are sampled
// rather than integrated; a candidate is refined by registration of the surface with itself and
// judged on samples of the surface; mirror images are left out, as no rigid motion makes them.
#pragma once

#include <vector>

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

struct SymmetrySettings {
    double tolerance = 0.01;  ///< of the diameter: how far a turned surface may be from itself;
                              ///< above 0, at most 0.05
    double outliers = 0.001;  ///< share of the surface that may be farther off; 0 to 0.05
    int max_order = 120;      ///< highest order sought of an axis that is not continuous; 2 to 360
    int samples = 4000;       ///< points that represent the surface, about; 500 to 100'000
};

/// Any turn about this line is a symmetry.
struct ContinuousAxis {
    Vec3d direction = Vec3d::UnitZ();  ///< unit length, model frame
    Vec3d point = Vec3d::Zero();       ///< on the axis, model frame and unit
};

/// All proper symmetries of a model. The discrete turns and the identity form a group, exactly.
/// With a continuous axis all symmetries are a turn about it after a discrete turn or none.
struct Symmetry {
    Vec3d center = Vec3d::Zero();      ///< fixed by all symmetries; model frame and unit
    std::vector<Pose> turns;           ///< T_model_model, discrete, without the identity; axes
                                       ///< of high order first, then by axis, then by angle
    std::vector<ContinuousAxis> axes;  ///< none; one; or three at right angles: any turn about
                                       ///< `center`, as of a sphere
    bool any() const { return !turns.empty() || !axes.empty(); }
};

/// Finds the symmetries of a surface. Both the surface turned by a symmetry and the surface itself
/// have all but `outliers` of their area within `tolerance` of the other one, on the side that
/// faces the same way. Details smaller than that, and holes narrower than the distance between
/// samples, don't break a symmetry. The same for the same input, bit for bit, on one thread.
/// @param surface   model frame, any unit; at least 100 valid points, of about even density, with
///                  normals, which all face outward or all inward.
/// @param diameter  of the model, in the same unit; no two points are farther apart.
/// @throws InvalidInput if the cloud is too small or has no normals, it doesn't fit the diameter,
/// or
///         a setting is out of range.
Symmetry find_symmetry(const PointCloud& surface, double diameter,
                       const SymmetrySettings& settings = {});

/// The same for a mesh, inner faces included. What it is made of, triangles large or small, and how
/// it lies don't matter. @param mesh  repaired, wound consistently.
Symmetry find_symmetry(const TriangleMesh& mesh, const SymmetrySettings& settings = {});

}  // namespace ostraka
