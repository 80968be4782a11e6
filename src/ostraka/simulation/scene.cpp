// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

TriangleMesh square(double side) {
    const auto half = static_cast<float>(side / 2.0);
    TriangleMesh mesh;
    mesh.vertices = {Vec3f(-half, -half, 0.0F), Vec3f(half, -half, 0.0F), Vec3f(half, half, 0.0F),
                     Vec3f(-half, half, 0.0F)};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

std::size_t count_pixels(const RenderedView& view, std::uint32_t mesh) {
    return static_cast<std::size_t>(std::count(view.mesh.begin(), view.mesh.end(), mesh));
}

double mean_diameter(const SceneModels& models, std::span<const std::uint32_t> chosen) {
    double sum = 0.0;
    for (const std::uint32_t model : chosen) sum += models.shapes[model].diameter;
    return sum / static_cast<double>(chosen.size());
}

// The pose of a mesh turned by R, its center above `place`, its lowest point at height 0.
Pose stand(const TriangleMesh& mesh, const MeshShape& shape, const Mat3d& R_world_model,
           const Vec3d& place) {
    Pose T_world_model = Pose::Identity();
    T_world_model.linear() = R_world_model;
    double lowest = std::numeric_limits<double>::max();
    for (const Vec3f& vertex : mesh.vertices) {
        lowest = std::min(lowest, (R_world_model * vertex.cast<double>()).z());
    }
    const Vec3d center = R_world_model * shape.center;
    T_world_model.translation() = Vec3d(place.x() - center.x(), place.y() - center.y(), -lowest);
    return T_world_model;
}

}  // namespace

SceneModels scene_models(std::vector<TriangleMesh> meshes) {
    SceneModels models{std::move(meshes), {}};
    models.shapes.resize(models.meshes.size());
    parallel_for(models.meshes.size(),
                 [&](std::size_t i) { models.shapes[i] = measure(models.meshes[i]); });
    return models;
}

SimulatedScene simulate_scene(const SceneModels& models, std::span<const PlacedModel> placed,
                              const SceneView& view) {
    std::vector<TriangleMesh> world;
    for (const PlacedModel& object : placed) {
        world.push_back(transformed(models.meshes[object.model], object.T_world_model));
    }
    if (view.table_size > 0.0) world.push_back(square(view.table_size));
    SimulatedScene scene;
    RenderedView rendered = render(RayScene(world), view.camera, view.T_camera_world, view.sensor);
    scene.objects.resize(placed.size());
    parallel_for(placed.size(), [&](std::size_t i) {
        const RenderedView alone = render(RayScene({world[i]}), view.camera, view.T_camera_world);
        const std::size_t total = count_pixels(alone, 0);
        const std::size_t seen = count_pixels(rendered, static_cast<std::uint32_t>(i));
        scene.objects[i] = {placed[i].model, view.T_camera_world * placed[i].T_world_model,
                            total > 0 ? double(seen) / double(total) : 0.0};
    });
    scene.cloud = std::move(rendered.cloud);
    scene.labels = std::move(rendered.mesh);
    for (std::uint32_t& label : scene.labels) {
        if (label >= placed.size()) label = kNoIndex;
    }
    return scene;
}

SimulatedScene simulate_tabletop(const SceneModels& models, std::span<const std::uint32_t> chosen,
                                 std::uint64_t number, const TabletopSettings& settings) {
    Random random(settings.seed, number);
    const double diameter = mean_diameter(models, chosen);
    std::vector<PlacedModel> placed;
    const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(double(chosen.size()))));
    const std::size_t rows = (chosen.size() + columns - 1) / columns;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const double step = settings.spacing * diameter;
        const Vec3d place(step * (double(i % columns) - (double(columns) - 1.0) / 2.0),
                          step * (double(i / columns) - (double(rows) - 1.0) / 2.0), 0.0);
        const std::uint32_t m = chosen[i];
        placed.push_back({m, stand(models.meshes[m], models.shapes[m], random.rotation(), place)});
    }
    const double azimuth = random.uniform(0.0, 2.0 * kPi);
    const double elevation = random.uniform(settings.min_elevation, settings.max_elevation);
    const double roll = random.uniform(-0.3, 0.3);
    const Vec3d target(0.0, 0.0, 0.3 * diameter);
    const double distance = settings.distance * diameter;
    const Vec3d eye =
        target + distance * Vec3d(std::cos(elevation) * std::cos(azimuth),
                                  std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    SceneView view{
        .camera = settings.camera,
        .T_camera_world = look_at(eye, target, Vec3d(0.0, std::sin(roll), std::cos(roll))),
        .sensor = settings.sensor,
        .table_size = 8.0 * diameter};
    view.sensor.seed = settings.sensor.seed + (number << 32U);
    return simulate_scene(models, placed, view);
}

SimulatedScene simulate_random_view(const SceneModels& models, std::uint64_t number,
                                    const RandomViewSettings& settings) {
    Random random(settings.seed, number);
    std::vector<std::uint32_t> all(models.meshes.size());
    std::iota(all.begin(), all.end(), 0U);
    const double diameter = mean_diameter(models, all);
    const auto choices =
        static_cast<std::uint32_t>(settings.max_objects - settings.min_objects + 1);
    const int count = settings.min_objects + static_cast<int>(random.below(choices));
    // Along the line of sight (z) each ball begins where the one before it ends.
    std::vector<PlacedModel> placed;
    double depth = 0.0;
    for (int i = 0; i < count; ++i) {
        const std::uint32_t model = random.below(static_cast<std::uint32_t>(models.meshes.size()));
        const MeshShape& shape = models.shapes[model];
        const double angle = random.uniform(0.0, 2.0 * kPi);
        const double aside = settings.spread * diameter * std::sqrt(random.uniform());
        const Vec3d place(aside * std::cos(angle), aside * std::sin(angle), depth + shape.radius);
        Pose T_world_model = Pose::Identity();
        T_world_model.linear() = random.rotation();
        T_world_model.translation() = place - T_world_model.linear() * shape.center;
        placed.push_back({model, T_world_model});
        depth += 2.0 * shape.radius;
    }
    const Vec3d middle(0.0, 0.0, depth / 2.0);
    const Vec3d eye = middle - Vec3d(0.0, 0.0, settings.distance * diameter);
    SceneView view{.camera = settings.camera,
                   .T_camera_world = look_at(eye, middle, Vec3d::UnitY()),
                   .sensor = settings.sensor};
    view.sensor.seed = settings.sensor.seed + (number << 32U);
    return simulate_scene(models, placed, view);
}

}  // namespace ostraka
