// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/render.hpp"

#include <cmath>
#include <limits>

#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

// What the sensor's optics see: truth, before the sensor's faults.
struct TrueView {
    DepthImage image;
    std::vector<std::uint32_t> mesh;
    std::vector<Vec3f> normals;  // camera frame, toward the sensor
};

Vec3d pixel_ray(const PinholeCamera& camera, std::size_t row, std::size_t column) {
    return camera.ray(static_cast<double>(column), static_cast<double>(row));
}

TrueView look(const RayScene& scene, const PinholeCamera& camera, const Pose& T_camera_world) {
    const auto width = static_cast<std::size_t>(camera.width);
    const auto height = static_cast<std::size_t>(camera.height);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    TrueView view{.image = {.width = camera.width, .height = camera.height}};
    view.image.depths.assign(width * height, 0.0);
    view.image.cosines.assign(width * height, 0.0);
    view.mesh.assign(width * height, kNoIndex);
    view.normals.assign(width * height, Vec3f(nan, nan, nan));
    const Pose T_world_camera = T_camera_world.inverse();
    const Mat3d R_world_camera = T_world_camera.linear();
    const Vec3d origin = T_world_camera.translation();
    parallel_for(height, [&](std::size_t row) {
        std::vector<Vec3d> directions(width);
        for (std::size_t column = 0; column < width; ++column) {
            directions[column] = R_world_camera * pixel_ray(camera, row, column);
        }
        const std::vector<RayHit> hits = scene.cast(origin, directions);
        for (std::size_t column = 0; column < width; ++column) {
            const RayHit& hit = hits[column];
            if (!hit.hit()) continue;
            const std::size_t pixel = row * width + column;
            Vec3d normal = scene.normal(hit);
            const double along = normal.dot(directions[column].normalized());
            if (along > 0.0) normal = -normal;
            view.image.depths[pixel] = std::max(0.0, hit.distance);
            view.image.cosines[pixel] = std::abs(along);
            view.mesh[pixel] = hit.mesh;
            view.normals[pixel] = Vec3d(T_camera_world.linear() * normal).cast<float>();
        }
    });
    return view;
}

// Pixels whose point the sensor's projector doesn't reach.
std::vector<char> shadow(const RayScene& scene, const PinholeCamera& camera,
                         const Pose& T_camera_world, const DepthImage& image,
                         const Vec3d& projector) {
    if (projector.isZero(0.0)) return {};
    const auto width = static_cast<std::size_t>(camera.width);
    const Pose T_world_camera = T_camera_world.inverse();
    const Vec3d eye = T_world_camera * projector;
    std::vector<char> shadowed(image.depths.size(), 0);
    parallel_for(static_cast<std::size_t>(camera.height), [&](std::size_t row) {
        std::vector<Vec3d> points;
        std::vector<std::size_t> pixels;
        for (std::size_t column = 0; column < width; ++column) {
            const double depth = image.depths[row * width + column];
            if (!(depth > 0.0)) continue;
            points.emplace_back(T_world_camera * (depth * pixel_ray(camera, row, column)));
            pixels.push_back(row * width + column);
        }
        const std::vector<char> hidden = scene.hidden(eye, points);
        for (std::size_t i = 0; i < pixels.size(); ++i) shadowed[pixels[i]] = hidden[i];
    });
    return shadowed;
}

}  // namespace

RenderedView render(const RayScene& scene, const PinholeCamera& camera, const Pose& T_camera_world,
                    const SensorModel& sensor) {
    TrueView truth = look(scene, camera, T_camera_world);
    const std::vector<double> depths = measured_depths(
        truth.image, shadow(scene, camera, T_camera_world, truth.image, sensor.projector), sensor);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    RenderedView view;
    view.T_camera_world = T_camera_world;
    view.cloud.width = camera.width;
    view.cloud.height = camera.height;
    view.cloud.points.assign(depths.size(), Vec3f(nan, nan, nan));
    view.normals = std::move(truth.normals);
    view.true_mesh = std::move(truth.mesh);
    view.mesh = view.true_mesh;
    const auto width = static_cast<std::size_t>(camera.width);
    for (std::size_t pixel = 0; pixel < depths.size(); ++pixel) {
        if (depths[pixel] > 0.0) {
            const Vec3d ray = pixel_ray(camera, pixel / width, pixel % width);
            view.cloud.points[pixel] = Vec3d(depths[pixel] * ray).cast<float>();
        } else {
            view.normals[pixel] = Vec3f(nan, nan, nan);
            view.mesh[pixel] = kNoIndex;
        }
    }
    return view;
}

RenderedView render(const RayScene& scene, const PinholeCamera& camera, const Pose& T_camera_world,
                    const SensorSettings& sensor) {
    return render(scene, camera, T_camera_world,
                  SensorModel{.ranging = sensor, .free_grazing_angle = sensor.max_grazing_angle});
}

}  // namespace ostraka
