// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

constexpr float kHalf = 25.0F;

TriangleMesh cube() {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f::Constant(-kHalf), Vec3f::Constant(kHalf));
    return mesh;
}

TriangleMesh plate(float half) {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(-half, -half, -0.5F), Vec3f(half, half, 0.5F));
    return mesh;
}

Pose at(double x, double y, double z) {
    Pose T_world_model = Pose::Identity();
    T_world_model.translation() = Vec3d(x, y, z);
    return T_world_model;
}

SceneModels box_models() {
    return scene_models({testing::corner_model(), testing::plate_model(), cube()});
}

bool same_bytes(const PointCloud& a, const PointCloud& b) {
    return a.size() == b.size() &&
           std::memcmp(a.points.data(), b.points.data(), a.size() * sizeof(Vec3f)) == 0;
}

TEST(SimulateScene, LabeledPointsLieOnTheirObject) {
    const SceneModels models = scene_models({cube()});
    Pose T_world_model = at(12.0, -5.0, 40.0);
    T_world_model.linear() = Random(4).rotation();
    const std::vector<PlacedModel> placed = {{0, T_world_model}};
    const SceneView view{.T_camera_world = look_at(Vec3d(200, 150, 250), Vec3d(10, 0, 30)),
                         .table_size = 400.0};
    const SimulatedScene scene = simulate_scene(models, placed, view);
    ASSERT_EQ(scene.objects.size(), 1U);
    EXPECT_DOUBLE_EQ(scene.objects[0].visible_fraction, 1.0);
    EXPECT_LT(
        (scene.objects[0].T_scene_model.matrix() - (view.T_camera_world * T_world_model).matrix())
            .norm(),
        1e-12);
    ASSERT_EQ(scene.labels.size(), scene.cloud.size());
    EXPECT_EQ(scene.cloud.viewpoint, Vec3f::Zero());
    const Pose T_model_scene = scene.objects[0].T_scene_model.inverse();
    const Pose T_world_camera = view.T_camera_world.inverse();
    std::size_t on_object = 0;
    std::size_t on_table = 0;
    for (std::size_t i = 0; i < scene.cloud.size(); ++i) {
        const Vec3f& point = scene.cloud.points[i];
        if (!point.allFinite()) {
            EXPECT_EQ(scene.labels[i], kNoIndex);
        } else if (scene.labels[i] == 0) {
            ++on_object;
            const Vec3d local = T_model_scene * point.cast<double>();
            ASSERT_NEAR(local.cwiseAbs().maxCoeff(), double{kHalf}, 1e-3);
        } else {
            ++on_table;
            ASSERT_EQ(scene.labels[i], kNoIndex);
            ASSERT_NEAR((T_world_camera * point.cast<double>()).z(), 0.0, 1e-3);
        }
    }
    EXPECT_GT(on_object, 5000U);
    EXPECT_GT(on_table, 50'000U);
}

TEST(SimulateScene, AnObjectHalfBehindAnotherIsHalfVisible) {
    // From far above both plates are seen at the same scale; the near one covers x > 0.
    const SceneModels models = scene_models({plate(30.0F), plate(60.0F)});
    const std::vector<PlacedModel> placed = {{0, at(0, 0, 0)}, {1, at(60.0, 0, 5.0)}};
    SceneView view{.T_camera_world = look_at(Vec3d(0, 0, 4000), Vec3d::Zero(), Vec3d::UnitY())};
    view.camera.fx = view.camera.fy = 9000.0;
    const SimulatedScene scene = simulate_scene(models, placed, view);
    EXPECT_NEAR(scene.objects[0].visible_fraction, 0.5, 0.02);
    EXPECT_DOUBLE_EQ(scene.objects[1].visible_fraction, 1.0);
    for (std::size_t i = 0; i < scene.labels.size(); ++i) {
        if (scene.labels[i] != 0) continue;
        const Vec3d world = view.T_camera_world.inverse() * scene.cloud.points[i].cast<double>();
        ASSERT_LT(world.x(), 0.5);
    }
}

TEST(SimulateScene, AnObjectOutOfSightIsNotVisible) {
    const SceneModels models = scene_models({cube()});
    const std::vector<PlacedModel> placed = {{0, at(0, 0, 5000.0)}};
    const SceneView view{.T_camera_world = look_at(Vec3d(0, 0, 300), Vec3d::Zero())};
    const SimulatedScene scene = simulate_scene(models, placed, view);
    EXPECT_EQ(scene.objects[0].visible_fraction, 0.0);
    for (const std::uint32_t label : scene.labels) ASSERT_EQ(label, kNoIndex);
}

TEST(SimulateTabletop, ObjectsTouchTheTableFromAbove) {
    const SceneModels models = box_models();
    const std::vector<std::uint32_t> chosen = {0, 1, 2, 1};
    for (std::uint64_t number = 0; number < 4; ++number) {
        const SimulatedScene scene =
            simulate_tabletop(models, chosen, number, {.spacing = 1.5, .seed = 3});
        ASSERT_EQ(scene.objects.size(), chosen.size());
        // The table: any three of its points give its plane, whose normal faces the camera.
        std::vector<Vec3d> table;
        for (std::size_t i = 0; i < scene.labels.size(); i += 101) {
            const Vec3f& point = scene.cloud.points[i];
            if (scene.labels[i] == kNoIndex && point.allFinite()) {
                table.push_back(point.cast<double>());
            }
        }
        ASSERT_GT(table.size(), 100U);
        const Vec3d& origin = table.front();
        Vec3d normal = Vec3d::Zero();
        for (std::size_t i = 2; i < table.size(); ++i) {
            const Vec3d cross = (table[i - 1] - origin).cross(table[i] - origin);
            if (cross.norm() > normal.norm()) normal = cross;
        }
        normal.normalize();
        if (normal.dot(origin) > 0.0) normal = -normal;
        for (std::size_t o = 0; o < chosen.size(); ++o) {
            EXPECT_EQ(scene.objects[o].model, chosen[o]);
            double lowest = 1e9;
            for (const Vec3f& vertex : models.meshes[chosen[o]].vertices) {
                const Vec3d placed = scene.objects[o].T_scene_model * vertex.cast<double>();
                lowest = std::min(lowest, normal.dot(placed - origin));
            }
            EXPECT_NEAR(lowest, 0.0, 0.01);
        }
    }
}

TEST(SimulateRandomView, KeepsAllWithinTheSensorsRange) {
    const SceneModels models = box_models();
    RandomViewSettings settings;
    settings.camera = resized(settings.camera, 64);
    settings.sensor.min_depth = 5.0 * mean_diameter(models);  // where the middle would be
    for (std::uint64_t number = 0; number < 10; ++number) {
        const SimulatedScene scene = simulate_random_view(models, number, settings);
        for (const TrueObject& object : scene.objects) {
            const MeshShape& shape = models.shapes[object.model];
            const double center = (object.T_scene_model * shape.center).z();
            EXPECT_GT(center - shape.radius, settings.sensor.min_depth);
        }
    }
}

TEST(SimulateRandomView, HasAsManyObjectsAsAskedForApartAndNoTable) {
    const SceneModels models = box_models();
    bool fewest = false;
    bool most = false;
    for (std::uint64_t number = 0; number < 30; ++number) {
        RandomViewSettings settings;
        settings.camera.width = 64;
        settings.camera.height = 48;
        settings.camera.fx = settings.camera.fy = 57.5;
        settings.camera.cx = 31.5;
        settings.camera.cy = 23.5;
        const SimulatedScene scene = simulate_random_view(models, number, settings);
        ASSERT_GE(scene.objects.size(), 3U);
        ASSERT_LE(scene.objects.size(), 5U);
        fewest = fewest || scene.objects.size() == 3;
        most = most || scene.objects.size() == 5;
        for (std::size_t i = 0; i < scene.labels.size(); ++i) {
            ASSERT_EQ(scene.labels[i] == kNoIndex, !scene.cloud.points[i].allFinite());
        }
        for (std::size_t o = 0; o < scene.objects.size(); ++o) {
            const TrueObject& object = scene.objects[o];
            ASSERT_LT(object.model, 3U);
            EXPECT_GE(object.visible_fraction, 0.0);
            EXPECT_LE(object.visible_fraction, 1.0);
            const MeshShape& shape = models.shapes[object.model];
            for (std::size_t other = 0; other < o; ++other) {
                const TrueObject& before = scene.objects[other];
                const MeshShape& shape_before = models.shapes[before.model];
                const Vec3d between = object.T_scene_model * shape.center -
                                      before.T_scene_model * shape_before.center;
                EXPECT_GE(between.norm(), shape.radius + shape_before.radius - 1e-6);
            }
        }
    }
    EXPECT_TRUE(fewest);
    EXPECT_TRUE(most);
}

TEST(SimulatedScenes, DependOnSeedAndNumberOnly) {
    const SceneModels models = box_models();
    TabletopSettings settings;
    settings.sensor.ranging.noise = 0.3;
    const std::vector<std::uint32_t> chosen = {0, 1};
    set_thread_count(1);
    const SimulatedScene one = simulate_tabletop(models, chosen, 5, settings);
    set_thread_count(4);
    const SimulatedScene four = simulate_tabletop(models, chosen, 5, settings);
    set_thread_count(0);
    EXPECT_TRUE(same_bytes(one.cloud, four.cloud));
    EXPECT_FALSE(same_bytes(one.cloud, simulate_tabletop(models, chosen, 6, settings).cloud));
    settings.seed = 1;
    EXPECT_FALSE(same_bytes(one.cloud, simulate_tabletop(models, chosen, 5, settings).cloud));
    EXPECT_TRUE(same_bytes(simulate_random_view(models, 2, {}).cloud,
                           simulate_random_view(models, 2, {}).cloud));
    EXPECT_FALSE(same_bytes(simulate_random_view(models, 2, {}).cloud,
                            simulate_random_view(models, 3, {}).cloud));
}

TEST(SimulatedScenes, NoiseHasItsDeviationAlongTheDepth) {
    const SceneModels models = box_models();
    TabletopSettings settings;
    const std::vector<std::uint32_t> chosen = {2};
    const SimulatedScene exact = simulate_tabletop(models, chosen, 1, settings);
    settings.sensor.ranging.noise = 0.4;
    const SimulatedScene noisy = simulate_tabletop(models, chosen, 1, settings);
    double squares = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < exact.cloud.size(); ++i) {
        if (!exact.cloud.points[i].allFinite()) continue;
        const double off = double{noisy.cloud.points[i].z()} - double{exact.cloud.points[i].z()};
        squares += off * off;
        count += 1.0;
    }
    EXPECT_NEAR(std::sqrt(squares / count), 0.4, 0.01);
}

}  // namespace
}  // namespace ostraka
