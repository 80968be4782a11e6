// SPDX-License-Identifier: Apache-2.0
// Aligns two plain clouds: iterative closest point, point to plane, with exact nearest neighbors.
// Chen, Medioni. Object Modelling by Registration of Multiple Range Images. 1992.
// Low. Linear Least-Squares Optimization for Point-to-Plane ICP Surface Registration. 2004.
// Departs from the papers: it starts with a few source points and ends with all of them; directions
// that the surface leaves free (along a plane, about a sphere) are left as they were guessed.
// (For a model's surface and thousands of guesses see icp.hpp.)
#pragma once

#include <memory>
#include <span>

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/registration/icp.hpp"

namespace ostraka {

struct CloudIcpSettings {
    double max_distance = 0.0;  ///< pairs farther apart are ignored, the points' unit; 0: none are
    int iterations = 50;        ///< at most, coarse ones included
    int coarse_points = 500;    ///< source points used until they have converged, then all are
    int neighbors = 10;         ///< in each target normal, where the target has none; at least 3
    double convergence = 1e-6;  ///< stop when a step moves the source by less than this times its
                                ///< radius; what is left is of the order of its square
};

/// A cloud made ready to be aligned with, for several calls.
class IcpTarget {
  public:
    /// @param cloud  finite points; its normals are used where it has them, else estimated. Points
    ///               without one (NaN, or on a line) are never paired. Copied.
    /// @throws InvalidInput if there is no point, or neighbors is below 3.
    explicit IcpTarget(const PointCloud& cloud, const CloudIcpSettings& settings = {});
    ~IcpTarget();
    IcpTarget(IcpTarget&&) noexcept;
    IcpTarget& operator=(IcpTarget&&) noexcept;

    struct Implementation;
    const Implementation& implementation() const { return *implementation_; }

  private:
    std::unique_ptr<Implementation> implementation_;
};

/// Moves the source onto the target from a first guess (up to about 15 degrees and a tenth of the
/// extent off, where the clouds overlap).
/// @param source  finite points in their own frame and the target's unit.
/// @param T_target_source  the first guess.
/// @return the pose, with `inliers` the pairs and `rms` their plane distances in the last step; the
///         guess itself, not converged, if a step finds fewer than 6 pairs. The same bits for any
///         number of threads.
/// @throws InvalidInput if a setting is out of range.
IcpResult align_clouds(const IcpTarget& target, std::span<const Vec3f> source,
                       const Pose& T_target_source, const CloudIcpSettings& settings = {});

/// The same at once. @throws InvalidInput also if the target is empty.
IcpResult align_clouds(const PointCloud& target, const PointCloud& source,
                       const Pose& T_target_source, const CloudIcpSettings& settings = {});

}  // namespace ostraka
