// SPDX-License-Identifier: Apache-2.0
// The frame of a piece: its centroid and principal directions with repeatable signs (method, 2.2).
#pragma once

#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

struct PrincipalFrame {
    Pose T_cloud_frame =
        Pose::Identity();  ///< columns: longest, middle, shortest direction; right-handed
    Vec3d deviations = Vec3d::Zero();  ///< standard deviation along each, descending, cloud's unit
    bool ambiguous_sign = false;   ///< the third moment doesn't decide the longest direction's sign
    bool ambiguous_order = false;  ///< the two longer directions are nearly equally long
};

/// Principal component analysis of the points. The shortest direction points to cloud.viewpoint;
/// the longest has a positive third moment; the middle one completes a right-handed frame.
/// @param cloud  at least 1 finite point; normals unused.
/// @throws InvalidInput if the cloud is empty.
PrincipalFrame principal_frame(const PointCloud& cloud);

/// T_cloud_frame and every other frame that a slightly different observation of the same piece
/// could have been given: 1, 2 or 4 frames, which differ by turns about the shortest direction.
std::vector<Pose> possible_frames(const PrincipalFrame& frame);

}  // namespace ostraka
