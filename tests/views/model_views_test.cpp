// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/model_views.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mesh/test_meshes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/views/viewpoints.hpp"

namespace ostraka {
namespace {

const ViewSettings kSettings{.count = 12, .sampling = 0.2};

TEST(ModelViews, CamerasStandOnASphereAndLookAtTheCenter) {
    const MeshShape shape = measure(test_meshes::lopsided());
    for (int index = 0; index < 12; ++index) {
        const Pose T_camera_model = view_camera(shape, kSettings, index);
        const Vec3d eye = T_camera_model.inverse().translation();
        EXPECT_NEAR((eye - shape.center).norm(), 3.0 * shape.diameter, 1e-9);
        const Vec3d center = T_camera_model * shape.center;
        EXPECT_LT(center.head<2>().norm(), 1e-9);
        EXPECT_GT(center.z(), 0.0);
        const Vec3d local = shape.axes.transpose() * (eye - shape.center).normalized();
        EXPECT_LT((local - viewpoints(12)[static_cast<std::size_t>(index)]).norm(), 1e-9);
    }
}

TEST(ModelViews, ShowTheWholeModelInsideTheImage) {
    const TriangleMesh mesh = test_meshes::lopsided();
    const RayScene scene({mesh});
    const MeshShape shape = measure(mesh);
    for (int index = 0; index < 12; ++index) {
        const RenderedView view = render_view(scene, shape, kSettings, index);
        const int width = view.cloud.width;
        const int height = view.cloud.height;
        for (int v = 0; v < height; ++v) {
            for (int u = 0; u < width; ++u) {
                const bool border = u == 0 || v == 0 || u == width - 1 || v == height - 1;
                const auto pixel = static_cast<std::size_t>(v * width + u);
                ASSERT_FALSE(border && view.cloud.points[pixel].allFinite());
            }
        }
    }
}

TEST(ModelViews, PointsLieOnTheSurfaceWithNormalsTowardTheSensor) {
    const TriangleMesh mesh = test_meshes::sphere(5.0, 90);
    const RayScene scene({mesh});
    const MeshShape shape = measure(mesh);
    for (const int index : {0, 5, 11}) {
        const ModelView view = make_view(scene, shape, kSettings, index);
        EXPECT_EQ(view.index, index);
        ASSERT_GT(view.cloud.size(), 1000U);
        ASSERT_EQ(view.cloud.normals.size(), view.cloud.size());
        EXPECT_NO_THROW(check(view.cloud));
        const Vec3d eye = view.T_camera_model.inverse().translation();
        EXPECT_LT((view.cloud.viewpoint.cast<double>() - eye).norm(), 1e-4);
        double error = 0.0;
        for (std::size_t i = 0; i < view.cloud.size(); ++i) {
            const Vec3d point = view.cloud.points[i].cast<double>();
            const Vec3d normal = view.cloud.normals[i].cast<double>();
            ASSERT_NEAR(point.norm(), 5.0, 0.02) << "a cell's mean lies a little inside";
            ASSERT_NEAR(normal.norm(), 1.0, 1e-5);
            ASSERT_GE(normal.dot(eye - point), 0.0);
            error += std::acos(std::min(1.0, normal.dot(point.normalized())));
        }
        EXPECT_LT(error / static_cast<double>(view.cloud.size()), 0.03);
    }
}

TEST(ModelViews, HaveTheSamplingDistance) {
    const TriangleMesh mesh = test_meshes::lopsided();
    const RayScene scene({mesh});
    const MeshShape shape = measure(mesh);
    for (const double sampling : {0.1, 0.2, 0.4}) {
        ViewSettings settings = kSettings;
        settings.sampling = sampling;
        const double mr = mesh_resolution(make_view(scene, shape, settings, 3).cloud.points);
        EXPECT_GT(mr, 0.5 * sampling);
        EXPECT_LT(mr, 1.1 * sampling);
    }
}

// Turning the model in its file must turn its views, so that the library doesn't depend on it.
TEST(ModelViews, TurnWithTheModel) {
    const TriangleMesh mesh = test_meshes::lopsided();
    const RayScene scene({mesh});
    const MeshShape shape = measure(mesh);
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
        const Pose pose = test_meshes::random_pose(seed, 20.0);
        const TriangleMesh turned_mesh = transformed(mesh, pose);
        const RayScene turned_scene({turned_mesh});
        const MeshShape turned_shape = measure(turned_mesh);
        for (const int index : {1, 8}) {
            const PointCloud a = transformed(make_view(scene, shape, kSettings, index).cloud, pose);
            const PointCloud b = make_view(turned_scene, turned_shape, kSettings, index).cloud;
            EXPECT_NEAR(static_cast<double>(a.size()), static_cast<double>(b.size()),
                        0.05 * static_cast<double>(a.size()));
            EXPECT_LT((a.viewpoint - b.viewpoint).norm(), 0.05 * shape.diameter);
            const KdTree tree(a.points);
            double mean = 0.0;
            for (const Vec3f& point : b.points) {
                mean += std::sqrt(tree.nearest(point).squared_distance);
            }
            EXPECT_LT(mean / static_cast<double>(b.size()), 0.5 * kSettings.sampling);
        }
    }
}

TEST(ModelViews, SensorNoiseDiffersFromViewToView) {
    const TriangleMesh mesh = test_meshes::sphere(5.0);
    const RayScene scene({mesh});
    const MeshShape shape = measure(mesh);
    ViewSettings settings = kSettings;
    settings.sensor.noise = 0.05;
    const auto noise_of = [&](int index) {
        const RenderedView noisy = render_view(scene, shape, settings, index);
        const RenderedView ideal = render_view(scene, shape, kSettings, index);
        const auto middle = noisy.cloud.size() / 2;
        return noisy.cloud.points[middle].z() - ideal.cloud.points[middle].z();
    };
    EXPECT_NE(noise_of(0), 0.0F);
    EXPECT_NE(noise_of(0), noise_of(1));
    EXPECT_EQ(noise_of(0), noise_of(0));
}

TEST(ModelViews, RejectSettingsThatMakeNoView) {
    const TriangleMesh mesh = test_meshes::box({1, 1, 1});
    const RayScene scene({mesh});
    const MeshShape shape = measure(mesh);
    const auto rejects = [&](auto change, int index = 0) {
        ViewSettings settings = kSettings;
        change(settings);
        EXPECT_THROW(make_view(scene, shape, settings, index), InvalidInput);
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    rejects([](ViewSettings& settings) { settings.count = 13; });
    rejects([](ViewSettings&) {}, 12);
    rejects([](ViewSettings&) {}, -1);
    for (const double value : {0.0, -1.0, nan, 1e-3, 1e-30}) {
        rejects([&](ViewSettings& settings) { settings.sampling = value; });
    }
    for (const double value : {0.0, -1.0, nan, 0.4}) {
        rejects([&](ViewSettings& settings) { settings.distance = value; });
    }
    for (const double value : {0.0, -1.0, nan, 1e30}) {
        rejects([&](ViewSettings& settings) { settings.rays_per_sample = value; });
    }
}

}  // namespace
}  // namespace ostraka
