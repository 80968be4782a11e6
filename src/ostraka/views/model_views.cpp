// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/model_views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/views/viewpoints.hpp"

namespace ostraka {
namespace {

constexpr int kMaxPixels = 2000;  // a side of the image; beyond it sampling is finer than sensible

PinholeCamera view_lens(const MeshShape& shape, const ViewSettings& settings) {
    const double distance = settings.distance * shape.diameter;
    if (!(distance > shape.radius)) {
        throw InvalidInput(fmt::format("views: a distance of {:.6g} diameters is inside the model",
                                       settings.distance));
    }
    if (!(settings.rays_per_sample > 0.0)) {
        throw InvalidInput("views: rays_per_sample must be positive");
    }
    const double spacing = settings.sampling / settings.rays_per_sample;
    PinholeCamera camera;
    camera.fx = camera.fy = distance / spacing;
    // The nearest point of the enclosing ball is seen under the widest angle.
    const double half =
        camera.fx * shape.radius / std::sqrt(distance * distance - shape.radius * shape.radius);
    const double pixels = 2.0 * std::ceil(half) + 3.0;
    if (!(pixels <= kMaxPixels)) {
        throw InvalidInput(fmt::format(
            "sampling {:.6g} is too fine for a model of diameter {:.6g}: at least {:.6g}",
            settings.sampling, shape.diameter, settings.sampling * pixels / kMaxPixels));
    }
    camera.width = camera.height = static_cast<int>(pixels);
    camera.cx = camera.cy = (pixels - 1.0) / 2.0;
    return camera;
}

}  // namespace

Pose view_camera(const MeshShape& shape, const ViewSettings& settings, int index) {
    const std::vector<Vec3d> locals = viewpoints(settings.count);
    if (index < 0 || index >= settings.count) {
        throw InvalidInput(fmt::format("view {} of {}", index, settings.count));
    }
    const Vec3d local = locals[static_cast<std::size_t>(index)];
    const Vec3d direction = shape.axes * local;
    const Vec3d eye = shape.center + settings.distance * shape.diameter * direction;
    return look_at(eye, shape.center, shape.axes.col(2));
}

RenderedView render_view(const RayScene& model, const MeshShape& shape,
                         const ViewSettings& settings, int index) {
    if (!(settings.sampling > 0.0)) throw InvalidInput("views: sampling must be positive");
    SensorSettings sensor = settings.sensor;
    sensor.seed += static_cast<std::uint64_t>(index) << 32U;
    return render(model, view_lens(shape, settings), view_camera(shape, settings, index), sensor);
}

ModelView make_view(const RenderedView& rendered, const ViewSettings& settings, int index) {
    PointCloud cloud = resample(rendered.cloud, settings.sampling);
    cloud.normals = estimate_normals_within(cloud, kNormalRadius * settings.sampling);
    ModelView view;
    view.index = index;
    view.T_camera_model = rendered.T_camera_world;
    view.cloud = transformed(remove_invalid(cloud), rendered.T_camera_world.inverse());
    return view;
}

ModelView make_view(const RayScene& model, const MeshShape& shape, const ViewSettings& settings,
                    int index) {
    return make_view(render_view(model, shape, settings, index), settings, index);
}

}  // namespace ostraka
