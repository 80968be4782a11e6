// SPDX-License-Identifier: Apache-2.0
// In which orientation a rigid object comes to rest on a plane.
// Rolled without momentum: about the lowest point, then about the edge of two, until the center of
// mass is above the polygon of the points in contact. That is the steepest descent of the center's
// height, h(d) = max over points p of d . (p - center), on the sphere of directions d that may be
// down. After Goldberg, Mirtich, Zhuang, Craig, Carlisle, Canny. Part Pose Statistics: Estimators
// and Experiments. IEEE Transactions on Robotics and Automation 15(5), 1999, whose quasi-static
// estimator it is, computed from event to event in closed form.
// Departs from it: no hull is built. The object rolls on some of the hull's vertices until it
// stands on another, which is then taken among them; so it rolls as on the whole hull.
#pragma once

#include "ostraka/simulation/rolling_shape.hpp"

namespace ostraka {

struct RestingPose {
    Mat3d R_world_model = Mat3d::Identity();  ///< the plane is horizontal, world z is up
    double height = 0.0;                      ///< of the center of mass above the plane
    int rolls = 0;                            ///< changes of the points it rolls about
    bool at_rest = false;                     ///< false: stopped after `max_rolls`
};

/// Sets a shape down on a plane in a rotation and lets it roll. The height never rises.
RestingPose roll_to_rest(const RollingShape& shape, const Mat3d& R_world_model,
                         int max_rolls = 10'000);

}  // namespace ostraka
