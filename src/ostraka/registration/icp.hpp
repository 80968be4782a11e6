// SPDX-License-Identifier: Apache-2.0
// Iterative closest point, point to plane, robust.
// Besl, McKay. A Method for Registration of 3-D Shapes. PAMI 14(2), 1992.
// Chen, Medioni. Object Modelling by Registration of Multiple Range Images. 1992 (point to plane).
// Departs from the papers: partners come from a SurfaceField (a table look-up, a cell's diagonal
// from the nearest; the plane distance forgives that), pairs are weighted by Tukey's biweight of
// their plane distance, and the acceptance distance shrinks from coarse to fine.
#pragma once

#include "ostraka/registration/surface_field.hpp"

namespace ostraka {

struct IcpSettings {
    int iterations = 20;          ///< at most
    double start_distance = 0.0;  ///< pairs farther apart are ignored at first; the points' unit
    double end_distance = 0.0;    ///< and in the end, reached after half of the iterations
    double min_cosine = 0.4;      ///< between the normals of a pair
    double convergence =
        1e-3;  ///< stop when a step moves the points by less than this times end_distance
};

struct IcpResult {
    Pose T_target_source = Pose::Identity();
    bool converged = false;  ///< the last step was below the limit
    int iterations = 0;      ///< steps made
    int inliers = 0;         ///< pairs in the last step
    double rms = 0.0;        ///< of their plane distances, the points' unit
};

/// Aligns points with a surface.
/// @param target   the surface's field.
/// @param source   points with normals, in their own frame.
/// @param T_target_source  the first guess.
/// @return the guess itself, not converged, if fewer than 6 pairs are found.
/// @throws InvalidInput if normals are missing or a distance isn't positive.
IcpResult icp(const SurfaceField& target, std::span<const Vec3f> source,
              std::span<const Vec3f> source_normals, const Pose& T_target_source,
              const IcpSettings& settings);

}  // namespace ostraka
