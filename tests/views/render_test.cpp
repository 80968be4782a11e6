// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/render.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <utility>

#include "mesh/test_meshes.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

const PinholeCamera kCamera{
    .width = 80, .height = 60, .fx = 100, .fy = 100, .cx = 39.5, .cy = 29.5};

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(Render, ShowsAWallAtItsDepthInEveryPixel) {
    const RayScene scene({test_meshes::box({100, 100, 1})});
    const Pose T_camera_world = look_at({0, 0, -11}, {0, 0, 0}, Vec3d::UnitY());
    const RenderedView view = render(scene, kCamera, T_camera_world);
    ASSERT_EQ(view.cloud.size(), 80U * 60U);
    EXPECT_NO_THROW(check(view.cloud));
    EXPECT_TRUE(view.cloud.organized());
    EXPECT_TRUE(view.cloud.normals.empty());
    for (std::size_t pixel = 0; pixel < view.cloud.size(); ++pixel) {
        const Vec3f& point = view.cloud.points[pixel];
        ASSERT_FLOAT_EQ(point.z(), 10.0F);
        ASSERT_EQ(view.mesh[pixel], 0U);
        ASSERT_LT((view.normals[pixel] - Vec3f(0, 0, -1)).norm(), 1e-6F);
        const Vec2d back = kCamera.project(point.cast<double>());
        ASSERT_NEAR(back.x(), static_cast<double>(pixel % 80), 1e-4);
        ASSERT_NEAR(back.y(), static_cast<double>(pixel / 80), 1e-4);
    }
}

TEST(Render, ShowsASphereAsADisk) {
    const RayScene scene({test_meshes::sphere(2.0, 90)});
    const RenderedView view = render(scene, kCamera, look_at({0, 0, 20}, {0, 0, 0}));
    std::size_t seen = 0;
    for (std::size_t pixel = 0; pixel < view.cloud.size(); ++pixel) {
        const Vec3f& point = view.cloud.points[pixel];
        ASSERT_EQ(point.allFinite(), view.mesh[pixel] == 0U);
        ASSERT_EQ(point.allFinite(), view.normals[pixel].allFinite());
        if (!point.allFinite()) continue;
        ++seen;
        const Vec3d from_center = point.cast<double>() - Vec3d(0, 0, 20);
        ASSERT_NEAR(from_center.norm(), 2.0, 3e-3);
        ASSERT_LT(view.normals[pixel].dot(point), 0.0F) << "toward the sensor";
        ASSERT_GT(view.normals[pixel].cast<double>().dot(from_center.normalized()), 0.998);
    }
    // The silhouette is a circle of radius f * r / sqrt(d^2 - r^2) pixels; the rays that graze it
    // at over 1.5 radians return nothing.
    const double radius = 100.0 * 2.0 / std::sqrt(400.0 - 4.0);
    EXPECT_NEAR(static_cast<double>(seen) / (kPi * radius * radius), 1.0, 0.06);
}

TEST(Render, WindingDoesNotMatter) {
    TriangleMesh mesh = test_meshes::lopsided(20);
    const Pose T_camera_world = look_at({9, 8, 20}, {0, 0, 0});
    const RenderedView outward = render(RayScene({mesh}), kCamera, T_camera_world);
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    const RenderedView inward = render(RayScene({mesh}), kCamera, T_camera_world);
    EXPECT_EQ(outward.mesh, inward.mesh);
    std::size_t seen = 0;
    for (std::size_t pixel = 0; pixel < outward.mesh.size(); ++pixel) {
        if (outward.mesh[pixel] == kNoIndex) continue;
        ++seen;
        ASSERT_LT((outward.normals[pixel] - inward.normals[pixel]).norm(), 1e-5F);
        ASSERT_LT((outward.cloud.points[pixel] - inward.cloud.points[pixel]).norm(), 1e-5F);
    }
    EXPECT_GT(seen, 300U);
}

TEST(Render, NearMeshHidesTheFarOne) {
    const TriangleMesh box = test_meshes::box({1, 1, 1});
    Pose behind = Pose::Identity();
    behind.translate(Eigen::Vector3d(0, 0, 10));
    const RayScene scene({transformed(scaled(box, 8.0), behind), box});
    const RenderedView view = render(scene, kCamera, look_at({0, 0, -10}, {0, 0, 0}));
    EXPECT_EQ(view.mesh[30 * 80 + 40], 1U);
    EXPECT_EQ(view.mesh[30 * 80 + 60], 0U);
}

TEST(Render, IsTheSameBytesForAnyNumberOfThreads) {
    const RayScene scene({test_meshes::lopsided()});
    const SensorSettings sensor{.noise = 0.05, .seed = 3};
    const Pose T_camera_world = look_at({9, 8, 20}, {0, 0, 0});
    set_thread_count(1);
    const RenderedView one = render(scene, kCamera, T_camera_world, sensor);
    set_thread_count(4);
    const RenderedView four = render(scene, kCamera, T_camera_world, sensor);
    set_thread_count(0);
    EXPECT_TRUE(same_bytes(one.cloud.points, four.cloud.points));
    EXPECT_TRUE(same_bytes(one.normals, four.normals));
    EXPECT_EQ(one.mesh, four.mesh);
}

TEST(Render, SensorNoiseMovesPointsAlongTheirRays) {
    const RayScene scene({test_meshes::box({100, 100, 1})});
    const Pose T_camera_world = look_at({0, 0, -11}, {0, 0, 0}, Vec3d::UnitY());
    const RenderedView view = render(scene, kCamera, T_camera_world, {.noise = 0.1, .seed = 1});
    double squares = 0.0;
    for (std::size_t pixel = 0; pixel < view.cloud.size(); ++pixel) {
        const Vec3d point = view.cloud.points[pixel].cast<double>();
        const Vec2d back = kCamera.project(point);
        ASSERT_NEAR(back.x(), static_cast<double>(pixel % 80), 1e-4);
        squares += (point.z() - 10.0) * (point.z() - 10.0);
    }
    EXPECT_NEAR(std::sqrt(squares / static_cast<double>(view.cloud.size())), 0.1, 0.006);
}

}  // namespace
}  // namespace ostraka
