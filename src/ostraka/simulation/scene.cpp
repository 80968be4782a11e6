// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

constexpr double kInRange = 1.05;  // of the sensor's smallest depth: the nearest that an object is

TriangleMesh square(double side) {
    const auto half = static_cast<float>(side / 2.0);
    TriangleMesh mesh;
    mesh.vertices = {Vec3f(-half, -half, 0.0F), Vec3f(half, -half, 0.0F), Vec3f(half, half, 0.0F),
                     Vec3f(-half, half, 0.0F)};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

// Columns or rows of an image, [first, last), that may show a ball: its outline lies between the
// tangents from the sensor. At most one image beyond the border on either side, as in BOP.
struct PixelRange {
    int first = 0;
    int last = 0;
};

PixelRange pixel_range(double center, double depth, double radius, double focal_length,
                       double principal, int size) {
    PixelRange range{-size, 2 * size};
    const double distance2 = center * center + depth * depth - radius * radius;
    if (depth <= 0.0 || distance2 <= 0.0) return range;
    const double middle = std::atan2(center, depth);
    const double half = std::atan2(radius, std::sqrt(distance2));
    if (middle - half > -1.5) {
        const double low = focal_length * std::tan(middle - half) + principal;
        range.first = static_cast<int>(std::clamp(std::floor(low), -1.0 * size, 2.0 * size));
    }
    if (middle + half < 1.5) {
        const double high = focal_length * std::tan(middle + half) + principal;
        range.last = static_cast<int>(std::clamp(std::ceil(high) + 1.0, -1.0 * size, 2.0 * size));
    }
    return range;
}

// Counts the pixels of one object and finds its silhouette: rays are cast only where it may be
// and is not known to be already.
void find_silhouette(const PlacedRayModel& placed, const MeshShape& shape, const SceneView& view,
                     std::uint32_t label, SimulatedScene& scene) {
    const PinholeCamera& camera = view.camera;
    const Vec3d center = scene.objects[label].T_scene_model * shape.center;
    const double radius = shape.radius * 1.001;
    const PixelRange columns =
        pixel_range(center.x(), center.z(), radius, camera.fx, camera.cx, camera.width);
    const PixelRange rows =
        pixel_range(center.y(), center.z(), radius, camera.fy, camera.cy, camera.height);
    const RayScene alone(std::vector<PlacedRayModel>{placed});
    const Pose T_world_camera = view.T_camera_world.inverse();
    const Vec3d origin = T_world_camera.translation();
    TrueObject& object = scene.objects[label];
    std::vector<std::uint32_t>& silhouette = scene.silhouettes[label];
    std::vector<Vec3d> directions;
    std::vector<int> asked;
    for (int row = rows.first; row < rows.last; ++row) {
        directions.clear();
        asked.clear();
        const bool inside_rows = row >= 0 && row < camera.height;
        const auto pixel_of = [&](int column) {
            return static_cast<std::uint32_t>(row * camera.width + column);
        };
        for (int column = columns.first; column < columns.last; ++column) {
            const bool inside = inside_rows && column >= 0 && column < camera.width;
            if (inside && scene.visible[pixel_of(column)] == label) {
                ++object.pixels_visible;
                ++object.pixels_total;
                silhouette.push_back(pixel_of(column));
                continue;
            }
            asked.push_back(column);
            directions.emplace_back(T_world_camera.linear() * camera.ray(column, row));
        }
        const std::vector<RayHit> hits = alone.cast(origin, directions);
        for (std::size_t i = 0; i < hits.size(); ++i) {
            if (!hits[i].hit()) continue;
            ++object.pixels_total;
            const bool inside = inside_rows && asked[i] >= 0 && asked[i] < camera.width;
            if (inside) silhouette.push_back(pixel_of(asked[i]));
        }
    }
    std::sort(silhouette.begin(), silhouette.end());
    if (object.pixels_total > 0) {
        object.visible_fraction =
            static_cast<double>(object.pixels_visible) / static_cast<double>(object.pixels_total);
    }
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

SceneModels scene_models(std::vector<TriangleMesh> meshes, std::vector<MeshShape> shapes) {
    SceneModels models{std::move(meshes), std::move(shapes), {}};
    if (models.shapes.size() != models.meshes.size()) {
        models.shapes.resize(models.meshes.size());
        parallel_for(models.meshes.size(),
                     [&](std::size_t i) { models.shapes[i] = measure(models.meshes[i]); });
    }
    for (const TriangleMesh& mesh : models.meshes) models.rays.emplace_back(mesh);
    return models;
}

double mean_diameter(const SceneModels& models, std::span<const std::uint32_t> chosen) {
    double sum = 0.0;
    for (const std::uint32_t model : chosen) sum += models.shapes[model].diameter;
    return sum / static_cast<double>(chosen.size());
}

double mean_diameter(const SceneModels& models) {
    double sum = 0.0;
    for (const MeshShape& shape : models.shapes) sum += shape.diameter;
    return sum / static_cast<double>(models.shapes.size());
}

Pose view_from_above(Random& random, const Vec3d& target, const ViewFromAbove& settings) {
    const double azimuth = random.uniform(0.0, 2.0 * kPi);
    const double elevation = random.uniform(settings.min_elevation, settings.max_elevation);
    const double roll = random.uniform(-0.3, 0.3);
    const Vec3d direction(std::cos(elevation) * std::cos(azimuth),
                          std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    return look_at(target + settings.distance * direction, target,
                   Vec3d(0.0, std::sin(roll), std::cos(roll)));
}

SimulatedScene simulate_scene(const SceneModels& models, std::span<const PlacedModel> placed,
                              const SceneView& view) {
    std::vector<PlacedRayModel> world;
    for (const PlacedModel& object : placed) {
        world.push_back({models.rays[object.model], object.T_world_model});
    }
    for (const RayModel& model : view.furniture) world.push_back({model});
    if (view.table_size > 0.0) world.push_back({RayModel(square(view.table_size))});
    SimulatedScene scene{.camera = view.camera, .T_camera_world = view.T_camera_world};
    RenderedView rendered = render(RayScene(world), view.camera, view.T_camera_world, view.sensor);
    scene.cloud = std::move(rendered.cloud);
    scene.labels = std::move(rendered.mesh);
    scene.visible = std::move(rendered.true_mesh);
    for (std::vector<std::uint32_t>* labels : {&scene.labels, &scene.visible}) {
        for (std::uint32_t& label : *labels) {
            if (label >= placed.size()) label = kNoIndex;
        }
    }
    scene.objects.resize(placed.size());
    scene.silhouettes.resize(placed.size());
    parallel_for(placed.size(), [&](std::size_t i) {
        scene.objects[i] = {placed[i].model, view.T_camera_world * placed[i].T_world_model};
        find_silhouette(world[i], models.shapes[placed[i].model], view,
                        static_cast<std::uint32_t>(i), scene);
    });
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
    const ViewFromAbove from{settings.min_elevation, settings.max_elevation,
                             settings.distance * diameter};
    SceneView view{.camera = settings.camera,
                   .T_camera_world = view_from_above(random, Vec3d(0.0, 0.0, 0.3 * diameter), from),
                   .sensor = settings.sensor,
                   .table_size = 8.0 * diameter};
    view.sensor.ranging.seed = settings.sensor.ranging.seed + (number << 32U);
    return simulate_scene(models, placed, view);
}

SimulatedScene simulate_random_view(const SceneModels& models, std::uint64_t number,
                                    const RandomViewSettings& settings) {
    Random random(settings.seed, number);
    const double diameter = mean_diameter(models);
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
    const double distance =
        std::max(settings.distance * diameter, depth / 2.0 + kInRange * settings.sensor.min_depth);
    const Vec3d eye = middle - Vec3d(0.0, 0.0, distance);
    SceneView view{.camera = settings.camera,
                   .T_camera_world = look_at(eye, middle, Vec3d::UnitY()),
                   .sensor = settings.sensor};
    view.sensor.ranging.seed = settings.sensor.ranging.seed + (number << 32U);
    return simulate_scene(models, placed, view);
}

}  // namespace ostraka
