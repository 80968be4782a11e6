// SPDX-License-Identifier: Apache-2.0
// The pinhole camera of a depth sensor, real or virtual.
#pragma once

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Camera frame: x right, y down, z forward; a pixel (u, v) has its center at integer coordinates.
struct PinholeCamera {
    int width = 640;    ///< pixels
    int height = 480;   ///< pixels
    double fx = 575.0;  ///< focal length, pixels
    double fy = 575.0;  ///< focal length, pixels
    double cx = 319.5;  ///< principal point, pixels
    double cy = 239.5;  ///< principal point, pixels

    /// Direction of the ray through pixel (u, v), with z = 1 (so that its parameter is the depth).
    Vec3d ray(double u, double v) const { return {(u - cx) / fx, (v - cy) / fy, 1.0}; }
    /// Pixel coordinates of a point in front of the camera.
    Vec2d project(const Vec3d& point) const {
        return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
    }
};

/// A camera with the same field of view and another number of pixels.
/// @param width  pixels; 0: as it is.
PinholeCamera resized(const PinholeCamera& camera, int width);

}  // namespace ostraka
