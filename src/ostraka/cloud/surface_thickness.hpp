// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

/// How thick noise makes a surface of which nobody knows from where it was seen: the median over
/// some thousand points of the RMS distance of the points within `radius` from their plane; cloud's
/// unit. Curvature counts as well. At most radius / sqrt(5), as of points that fill the ball.
/// @param cloud   all points finite.
/// @param radius  of the balls, cloud's unit, positive.
/// @return 0 if no point has a plane around it.
double surface_thickness(const PointCloud& cloud, double radius);

}  // namespace ostraka
