// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/render.hpp"

#include <cmath>
#include <limits>

#include "ostraka/base/parallel.hpp"

namespace ostraka {

RenderedView render(const RayScene& scene, const PinholeCamera& camera, const Pose& T_camera_world,
                    const SensorSettings& sensor) {
    const auto width = static_cast<std::size_t>(camera.width);
    const auto height = static_cast<std::size_t>(camera.height);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    RenderedView view;
    view.T_camera_world = T_camera_world;
    view.cloud.width = camera.width;
    view.cloud.height = camera.height;
    view.cloud.points.assign(width * height, Vec3f(nan, nan, nan));
    view.normals.assign(width * height, Vec3f(nan, nan, nan));
    view.mesh.assign(width * height, kNoIndex);
    const Pose T_world_camera = T_camera_world.inverse();
    const Mat3d R_world_camera = T_world_camera.linear();
    const Vec3d origin = T_world_camera.translation();
    parallel_for(height, [&](std::size_t row) {
        std::vector<Vec3d> directions(width);
        for (std::size_t column = 0; column < width; ++column) {
            directions[column] =
                R_world_camera * camera.ray(static_cast<double>(column), static_cast<double>(row));
        }
        const std::vector<RayHit> hits = scene.cast(origin, directions);
        for (std::size_t column = 0; column < width; ++column) {
            const RayHit& hit = hits[column];
            if (!hit.hit()) continue;
            Vec3d normal = scene.normal(hit);
            const double along = normal.dot(directions[column].normalized());
            if (along > 0.0) normal = -normal;
            const std::size_t pixel = row * width + column;
            const double depth = measured_depth(hit.distance, std::abs(along), pixel, sensor);
            if (!(depth > 0.0)) continue;
            const Vec3d ray = camera.ray(static_cast<double>(column), static_cast<double>(row));
            view.cloud.points[pixel] = Vec3d(depth * ray).cast<float>();
            view.normals[pixel] = Vec3d(T_camera_world.linear() * normal).cast<float>();
            view.mesh[pixel] = hit.mesh;
        }
    });
    return view;
}

}  // namespace ostraka
