// SPDX-License-Identifier: Apache-2.0
// A depth image of placed meshes, as an organized cloud.
#pragma once

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/views/camera.hpp"
#include "ostraka/views/ray_scene.hpp"
#include "ostraka/views/sensor_model.hpp"

namespace ostraka {

struct RenderedView {
    PointCloud cloud;  ///< organized, camera frame, sensor at the origin; NaN: no return;
                       ///< its normals stay empty: a sensor gives none
    std::vector<std::uint32_t> mesh;       ///< per pixel: number of the mesh seen, or kNoIndex
    std::vector<std::uint32_t> true_mesh;  ///< the same before the sensor's faults
    std::vector<Vec3f> normals;  ///< per pixel: the true normal, camera frame, toward the sensor
    Pose T_camera_world = Pose::Identity();
};

/// Casts one ray a pixel, and one to the projector of a sensor that has one.
/// @param scene  in the world frame.
RenderedView render(const RayScene& scene, const PinholeCamera& camera, const Pose& T_camera_world,
                    const SensorModel& sensor);
RenderedView render(const RayScene& scene, const PinholeCamera& camera, const Pose& T_camera_world,
                    const SensorSettings& sensor = {});

}  // namespace ostraka
