// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/pose_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

// Straight from the definition, in the scene's frame.
double adi_by_definition(const std::vector<Vec3f>& points, const Pose& truth,
                         const Pose& estimate) {
    double sum = 0.0;
    for (const Vec3f& a : points) {
        double best = 1e300;
        for (const Vec3f& b : points) {
            best = std::min(best, (truth * a.cast<double>() - estimate * b.cast<double>()).norm());
        }
        sum += best;
    }
    return sum / static_cast<double>(points.size());
}

Pose random_pose(Random& random) {
    Pose pose = Pose::Identity();
    pose.linear() = random.rotation();
    pose.translation() = 5.0 * random.direction();
    return pose;
}

TEST(Adi, AgreesWithItsDefinitionOnRandomPoses) {
    Random random(1);
    std::vector<Vec3f> points;
    for (int i = 0; i < 60; ++i) points.push_back(Vec3d(10.0 * random.direction()).cast<float>());
    for (int i = 0; i < 100; ++i) {
        const Pose truth = random_pose(random);
        const Pose estimate = random_pose(random);
        EXPECT_NEAR(adi_error(points, truth, estimate), adi_by_definition(points, truth, estimate),
                    1e-4);
    }
}

TEST(Adi, ForgivesSymmetry) {
    const std::vector<Vec3f> square = {Vec3f(1, 1, 0), Vec3f(-1, 1, 0), Vec3f(-1, -1, 0),
                                       Vec3f(1, -1, 0)};
    Pose quarter = Pose::Identity();
    quarter.rotate(Eigen::AngleAxisd(kPi / 2.0, Eigen::Vector3d::UnitZ()));
    EXPECT_NEAR(adi_error(square, Pose::Identity(), quarter), 0.0, 1e-6);
    Pose aside = Pose::Identity();
    aside.translation() = Vec3d(0.0, 0.0, 0.25);
    EXPECT_NEAR(adi_error(square, Pose::Identity(), aside), 0.25, 1e-6);
}

TEST(Adi, NoPointsGiveZero) {
    EXPECT_EQ(adi_error({}, Pose::Identity(), Pose::Identity()), 0.0);
}

}  // namespace
}  // namespace ostraka
