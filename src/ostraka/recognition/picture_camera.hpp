// SPDX-License-Identifier: Apache-2.0
// The camera of a picture of a scan: at the scan's viewpoint, fitted to what the scan holds.
#pragma once

#include <span>

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/recognition/canvas.hpp"
#include "ostraka/views/camera.hpp"

namespace ostraka {

struct PictureCamera {
    PinholeCamera pinhole;  ///< of the whole picture
    Pose T_camera_scene = Pose::Identity();
    Rectangle scan;  ///< part of the picture that shows the scan; the rest is margin
};

/// Looks from scene.viewpoint at the middle of the scan. An organized scan's rows are horizontal;
/// otherwise x is to the right where the sensor looks along z (camera frames of both conventions),
/// else z is up. A scan all around its viewpoint is seen from outside.
/// @param objects  points of placed models: the picture grows by up to 12 % a side to hold them.
/// @param width  of the picture, pixels.
/// @param top    rows at the picture's top that stay free.
/// @return the height follows from the scan's shape: 0.45 to 0.72 of the width, plus `top`.
PictureCamera fit_camera(const PointCloud& scene, std::span<const Vec3f> objects, int width,
                         int top);

}  // namespace ostraka
