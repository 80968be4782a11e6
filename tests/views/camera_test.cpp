// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/camera.hpp"

#include <gtest/gtest.h>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

TEST(PinholeCamera, ProjectUndoesRay) {
    const PinholeCamera camera{
        .width = 640, .height = 480, .fx = 570, .fy = 580, .cx = 300, .cy = 250};
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        const Vec2d pixel(random.uniform(-100, 800), random.uniform(-100, 600));
        const double depth = random.uniform(0.1, 50.0);
        const Vec3d ray = camera.ray(pixel.x(), pixel.y());
        EXPECT_EQ(ray.z(), 1.0) << "the ray's parameter is the depth";
        EXPECT_LT((camera.project(depth * ray) - pixel).norm(), 1e-9);
    }
}

TEST(PinholeCamera, RightAndDownArePositive) {
    const PinholeCamera camera;
    const Vec2d center(camera.cx, camera.cy);
    EXPECT_EQ(camera.project({0, 0, 2}), center);
    EXPECT_GT(camera.project({1, 0, 2}).x(), center.x());
    EXPECT_GT(camera.project({0, 1, 2}).y(), center.y());
    EXPECT_DOUBLE_EQ(camera.project({1, 0, 2}).x(), camera.cx + camera.fx / 2.0);
}

void expect_looks(const Pose& T_camera_world, const Vec3d& eye, const Vec3d& target) {
    const Mat3d R = T_camera_world.linear();
    EXPECT_LT((R * R.transpose() - Mat3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(R.determinant(), 1.0, 1e-12);
    EXPECT_LT((T_camera_world * eye).norm(), 1e-9) << "the eye is the origin";
    EXPECT_LT((T_camera_world * target - Vec3d(0, 0, (target - eye).norm())).norm(), 1e-9);
}

TEST(LookAt, PutsTheTargetOnTheAxis) {
    Random random(2);
    for (int i = 0; i < 100; ++i) {
        const Vec3d eye = random.uniform(0.1, 10.0) * random.direction();
        const Vec3d target = random.uniform(0.1, 10.0) * random.direction();
        const Vec3d up = random.uniform(0.1, 5.0) * random.direction();
        const Pose T_camera_world = look_at(eye, target, up);
        expect_looks(T_camera_world, eye, target);
        const Vec3d up_in_camera = T_camera_world.linear() * up;
        EXPECT_NEAR(up_in_camera.x(), 0.0, 1e-9);
        EXPECT_LT(up_in_camera.y(), 0.0) << "y points down";
    }
}

TEST(LookAt, ReplacesAnUpThatIsParallelToTheView) {
    for (const Vec3d& direction :
         {Vec3d(1, 0, 0), Vec3d(0, -1, 0), Vec3d(0, 0, 1), Vec3d(1, 2, 3)}) {
        expect_looks(look_at(Vec3d::Zero(), direction, direction), Vec3d::Zero(), direction);
        expect_looks(look_at(direction, Vec3d::Zero(), direction), direction, Vec3d::Zero());
        expect_looks(look_at(direction, Vec3d::Zero(), Vec3d::Zero()), direction, Vec3d::Zero());
    }
}

}  // namespace
}  // namespace ostraka
