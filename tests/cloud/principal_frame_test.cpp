// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/principal_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

// Uniform in the ellipsoid with the given half axes, around the origin.
PointCloud ellipsoid(const Vec3d& half, std::size_t count = 20'000) {
    Random random(1);
    PointCloud cloud;
    while (cloud.size() < count) {
        const Vec3d p = random.direction() * std::cbrt(random.uniform());
        cloud.points.push_back(half.cwiseProduct(p).cast<float>());
    }
    cloud.viewpoint = Vec3f(0.0F, 0.0F, 100.0F);
    return cloud;
}

// A drop shape: long along x and heavier at its negative end, so that x has a positive skewness.
PointCloud drop() {
    Random random(2);
    PointCloud cloud;
    for (int i = 0; i < 5000; ++i) {
        const double along = -std::log(1.0 - random.uniform());  // exponential: skewness 2
        cloud.points.push_back(
            Vec3d(4.0 * along, random.normal(), 0.3 * random.normal()).cast<float>());
    }
    cloud.viewpoint = Vec3f(0.0F, 0.0F, 100.0F);
    return cloud;
}

void expect_rigid(const Pose& pose) {
    const Mat3d axes = pose.linear();
    EXPECT_LT((axes.transpose() * axes - Mat3d::Identity()).norm(), 1e-9);
    EXPECT_NEAR(axes.determinant(), 1.0, 1e-9);
}

TEST(PrincipalFrame, OfAnEllipsoidIsItsAxes) {
    const Pose T_cloud_ellipsoid = test_clouds::random_pose(5);
    const PointCloud cloud = transformed(ellipsoid({7.0, 4.0, 2.0}), T_cloud_ellipsoid);
    const PrincipalFrame frame = principal_frame(cloud);
    expect_rigid(frame.T_cloud_frame);
    const Mat3d R = T_cloud_ellipsoid.linear().transpose() * frame.T_cloud_frame.linear();
    EXPECT_LT((R.cwiseAbs() - Mat3d::Identity()).norm(), 0.05);
    EXPECT_LT((frame.T_cloud_frame.translation() - T_cloud_ellipsoid.translation()).norm(), 0.15);
    // The variance of a uniform ellipsoid along a half axis a is a^2 / 5.
    const Vec3d expected = Vec3d(7.0, 4.0, 2.0) / std::sqrt(5.0);
    EXPECT_LT((frame.deviations - expected).cwiseQuotient(expected).cwiseAbs().maxCoeff(), 0.02);
    EXPECT_TRUE(frame.ambiguous_sign) << "an ellipsoid's two ends are alike";
    EXPECT_FALSE(frame.ambiguous_order);
}

TEST(PrincipalFrame, ShortestAxisPointsToTheViewpoint) {
    for (const float side : {1.0F, -1.0F}) {
        PointCloud cloud = drop();
        cloud.viewpoint = Vec3f(20.0F, 30.0F, side * 60.0F);
        EXPECT_GT(side * principal_frame(cloud).T_cloud_frame.linear()(2, 2), 0.9);
    }
}

TEST(PrincipalFrame, LongestAxisHasAPositiveThirdMoment) {
    const PointCloud cloud = drop();
    const PrincipalFrame frame = principal_frame(cloud);
    EXPECT_GT(frame.T_cloud_frame.linear()(0, 0), 0.99);
    EXPECT_FALSE(frame.ambiguous_sign);
    PointCloud mirrored = cloud;
    for (Vec3f& point : mirrored.points) point.x() = -point.x();
    EXPECT_LT(principal_frame(mirrored).T_cloud_frame.linear()(0, 0), -0.99);
}

TEST(PrincipalFrame, TurnsWithTheCloud) {
    const PointCloud cloud = drop();
    const PrincipalFrame before = principal_frame(cloud);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Pose pose = test_clouds::random_pose(seed, 30.0);
        const PrincipalFrame after = principal_frame(transformed(cloud, pose));
        const Pose expected = pose * before.T_cloud_frame;
        EXPECT_LT((after.T_cloud_frame.matrix() - expected.matrix()).norm(), 1e-3);
        EXPECT_LT((after.deviations - before.deviations).norm(), 1e-3);
        EXPECT_EQ(after.ambiguous_sign, before.ambiguous_sign);
        EXPECT_EQ(after.ambiguous_order, before.ambiguous_order);
    }
}

TEST(PrincipalFrame, FlagsEquallyLongAxes) {
    EXPECT_TRUE(principal_frame(ellipsoid({5.0, 4.9, 1.0})).ambiguous_order);
    EXPECT_FALSE(principal_frame(ellipsoid({5.0, 3.5, 1.0})).ambiguous_order);
}

TEST(PrincipalFrame, PossibleFramesAreOneTwoOrFour) {
    PrincipalFrame frame;
    frame.T_cloud_frame = test_clouds::random_pose(8);
    EXPECT_EQ(possible_frames(frame).size(), 1U);
    frame.ambiguous_sign = true;
    EXPECT_EQ(possible_frames(frame).size(), 2U);
    frame.ambiguous_order = true;
    EXPECT_EQ(possible_frames(frame).size(), 4U);
    frame.ambiguous_sign = false;
    EXPECT_EQ(possible_frames(frame).size(), 4U);
}

TEST(PrincipalFrame, PossibleFramesKeepOriginAndShortestAxis) {
    PrincipalFrame frame;
    frame.T_cloud_frame = test_clouds::random_pose(9);
    frame.ambiguous_order = true;
    const std::vector<Pose> frames = possible_frames(frame);
    EXPECT_TRUE(frames.front().isApprox(frame.T_cloud_frame));
    for (std::size_t i = 0; i < frames.size(); ++i) {
        expect_rigid(frames[i]);
        EXPECT_LT((frames[i].translation() - frame.T_cloud_frame.translation()).norm(), 1e-12);
        EXPECT_LT((frames[i].linear().col(2) - frame.T_cloud_frame.linear().col(2)).norm(), 1e-12);
        for (std::size_t j = 0; j < i; ++j) {
            EXPECT_LT(frames[i].linear().col(0).dot(frames[j].linear().col(0)), 1e-9);
        }
    }
    frame.ambiguous_order = false;
    frame.ambiguous_sign = true;
    const std::vector<Pose> pair = possible_frames(frame);
    EXPECT_LT((pair[0].linear().col(0) + pair[1].linear().col(0)).norm(), 1e-12);
}

// Whatever sign a symmetric piece gets, one of the possible frames is the true one.
TEST(PrincipalFrame, PossibleFramesHoldTheFrameOfANoisyObservation) {
    const PointCloud clean = ellipsoid({5.0, 4.9, 1.0}, 2000);
    const std::vector<Pose> possible = possible_frames(principal_frame(clean));
    Random random(4);
    for (int trial = 0; trial < 10; ++trial) {
        PointCloud noisy = clean;
        const double stretch = trial % 2 == 0 ? 1.1 : 0.9;
        for (Vec3f& point : noisy.points) {
            point.x() *= static_cast<float>(stretch);
            point += Vec3d(0.01 * random.direction()).cast<float>();
        }
        const Mat3d R = principal_frame(noisy).T_cloud_frame.linear();
        double best = 10.0;
        for (const Pose& frame : possible) best = std::min(best, (frame.linear() - R).norm());
        EXPECT_LT(best, 0.7);
    }
}

TEST(PrincipalFrame, OfFewPointsIsStillAFrame) {
    PointCloud cloud;
    EXPECT_THROW(principal_frame(cloud), InvalidInput);
    cloud.points = {{1, 2, 3}};
    expect_rigid(principal_frame(cloud).T_cloud_frame);
    EXPECT_EQ(principal_frame(cloud).T_cloud_frame.translation(), Eigen::Vector3d(1, 2, 3));
    cloud.points = {{0, 0, 0}, {2, 0, 0}};
    const PrincipalFrame pair = principal_frame(cloud);
    expect_rigid(pair.T_cloud_frame);
    EXPECT_NEAR(std::abs(pair.T_cloud_frame.linear()(0, 0)), 1.0, 1e-9);
    EXPECT_NEAR(pair.deviations[0], 1.0, 1e-9);
}

}  // namespace
}  // namespace ostraka
