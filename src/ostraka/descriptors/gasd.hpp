// SPDX-License-Identifier: Apache-2.0
// GASD: Globally Aligned Spatial Distribution, shape part: an 8 x 8 x 8 grid in the aligned frame.
// Lima, Teichrieb. An Efficient Global Point Cloud Descriptor for Object Recognition and Pose
// Estimation. SIBGRAPI 2016.
// As PCL 1.13 by default: half grid 4, one bin a cell, trilinear interpolation. PCL departs from
// the paper in that a point counts only while it lies in the outer half of its spherical shell (the
// largest distance has 4 shells); the row's sum is then near 50, not 100. So do we by default.
// Departs from PCL: PCL leaves the sign of the x axis to its eigenvector routine, so that a rotated
// cloud may get another row. Here the third moment decides; AxisSign::pcl gives PCL's own choice.
#pragma once

#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

inline constexpr std::size_t kGasdLength = 512;

struct GasdSettings {
    enum class AxisSign {
        third_moment,  ///< the sum of cubed x coordinates is not negative; rotates with the cloud
        pcl,           ///< as PCL 1.13; depends on the frame the cloud is given in
    };
    AxisSign x_sign = AxisSign::third_moment;
    bool outer_half_only = true;  ///< as PCL 1.13; false: every point counts, as in the paper
};

/// The aligned frame: aligned = R_aligned_cloud * (point - centroid).
struct GasdFrame {
    Mat3d R_aligned_cloud = Mat3d::Identity();  ///< rows: x most spread, y, z least spread, toward
                                                ///< the viewpoint; right-handed
    Vec3d centroid = Vec3d::Zero();             ///< mean point, in the cloud's frame and unit
    double x_skewness = 0.0;  ///< sum of x^3 over sum of |x|^3, in [-1, 1]; near 0 the sign of x
                              ///< (and with it of y) is a toss-up: try both
};

/// The frame of a piece; also its pose relative to another piece with a like row:
/// T_a_b = frame_a^-1 * frame_b.
/// @param cloud  at least 1 point, finite; cloud.viewpoint is used, normals are not.
/// @return always a right-handed rotation, arbitrary where the spread has no unique axes.
/// @throws InvalidInput if there are no points or a point is not finite.
GasdFrame gasd_frame(const PointCloud& cloud, const GasdSettings& settings = {});

/// The frame as a pose, T_aligned_cloud.
Pose gasd_pose(const GasdFrame& frame);

/// @param cloud  at least 1 point, finite; cloud.viewpoint is used, normals are not.
/// @return kGasdLength non-negative floats, x slowest and z fastest; all 0 if all points coincide.
///         The same for any order of the points, and up to rounding for any rigid motion and scale.
/// @throws InvalidInput as gasd_frame().
std::vector<float> describe_gasd(const PointCloud& cloud, const GasdSettings& settings = {});

/// The same in a frame that is known already.
std::vector<float> describe_gasd(const PointCloud& cloud, const GasdFrame& frame,
                                 const GasdSettings& settings = {});

}  // namespace ostraka
