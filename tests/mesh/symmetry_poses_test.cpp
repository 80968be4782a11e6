// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/symmetry_poses.hpp"

#include <gtest/gtest.h>

#include "mesh/test_meshes.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

using test_meshes::random_pose;

Pose turn(const Vec3d& axis, double angle, const Vec3d& point) {
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
    pose.translation() = point - pose.linear() * point;
    return pose;
}

const Vec3d kCenter(1.0, -2.0, 0.5);
const Vec3d kAxis = Vec3d(1.0, 2.0, -0.5).normalized();

Symmetry three_fold() {
    return {
        .center = kCenter,
        .turns = {turn(kAxis, 2.0 * kPi / 3.0, kCenter), turn(kAxis, 4.0 * kPi / 3.0, kCenter)}};
}

Symmetry cylinder() {
    return {.center = kCenter,
            .turns = {turn(kAxis.unitOrthogonal(), kPi, kCenter)},
            .axes = {{kAxis, kCenter}}};
}

Symmetry ball() {
    return {
        .center = kCenter,
        .axes = {{Vec3d::UnitX(), kCenter}, {Vec3d::UnitY(), kCenter}, {Vec3d::UnitZ(), kCenter}}};
}

double angle_between(const Pose& a, const Pose& b) {
    return Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle();
}

double difference(const Pose& a, const Pose& b) {
    return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

TEST(EquivalentPoses, CombineAsBopDoes) {
    const Symmetry symmetry = cylinder();
    const std::vector<Pose> motions = symmetry_motions(symmetry, 4);
    ASSERT_EQ(motions.size(), 8U);
    for (int d = 0; d < 2; ++d) {
        for (int k = 0; k < 4; ++k) {
            // The toolkit's R = R_cont R_disc, t = R_cont t_disc + t_cont, t_cont = o - R_cont o.
            const Mat3d R_cont =
                Eigen::AngleAxisd(kPi / 2.0 * k, Eigen::Vector3d(kAxis)).toRotationMatrix();
            const Pose discrete = d == 0 ? Pose::Identity() : symmetry.turns[0];
            const Pose& found = motions[static_cast<std::size_t>(4 * d + k)];
            EXPECT_LT((found.linear() - R_cont * discrete.linear()).norm(), 1e-12);
            const Vec3d t = R_cont * discrete.translation() + kCenter - R_cont * kCenter;
            EXPECT_LT((found.translation() - t).norm(), 1e-12);
        }
    }
    const Pose pose = random_pose(5);
    const std::vector<Pose> poses = equivalent_poses(symmetry, pose, 4);
    ASSERT_EQ(poses.size(), 8U);
    EXPECT_EQ(difference(poses[0], pose), 0.0);
    EXPECT_LT(difference(poses[5], pose * motions[5]), 1e-12);
}

TEST(EquivalentPoses, CountStepsOfContinuousAxesOnly) {
    const Pose pose = random_pose(6);
    EXPECT_EQ(equivalent_poses({}, pose, 36).size(), 1U);
    EXPECT_EQ(equivalent_poses(three_fold(), pose, 36).size(), 3U);
    EXPECT_EQ(equivalent_poses(cylinder(), pose, 36).size(), 72U);
    EXPECT_EQ(equivalent_poses(cylinder(), pose, 1).size(), 2U);
    EXPECT_EQ(equivalent_poses(ball(), pose, 36).size(), 1U + 3U * 35U);
    EXPECT_THROW(equivalent_poses(cylinder(), pose, 0), InvalidInput);
}

TEST(NearestEquivalentPose, IsExactWhereBruteForceIsClose) {
    constexpr int kSteps = 720;
    for (const Symmetry& symmetry : {three_fold(), cylinder()}) {
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
            const Pose pose = random_pose(seed);
            const Pose reference = random_pose(seed + 100);
            double least = 10.0;
            for (const Pose& other : equivalent_poses(symmetry, pose, kSteps)) {
                least = std::min(least, angle_between(other, reference));
            }
            const Pose nearest = nearest_equivalent_pose(symmetry, pose, reference);
            EXPECT_LE(angle_between(nearest, reference), least + 1e-9);
            EXPECT_GT(angle_between(nearest, reference), least - kPi / kSteps);
            EXPECT_LT((nearest * kCenter - pose * kCenter).norm(), 1e-9);
        }
    }
}

TEST(NearestEquivalentPose, UndoesASymmetry) {
    const Pose pose = random_pose(9);
    const Pose turned = pose * turn(kAxis, 1.234, kCenter) * cylinder().turns[0];
    EXPECT_LT(difference(nearest_equivalent_pose(cylinder(), turned, pose), pose), 1e-9);
    const Pose rolled = pose * turn({0.3, 0.2, 0.9}, 2.5, kCenter);
    EXPECT_LT(difference(nearest_equivalent_pose(ball(), rolled, pose), pose), 1e-9);
    EXPECT_EQ(difference(nearest_equivalent_pose({}, turned, pose), turned), 0.0);
}

TEST(SymmetricDifference, ForgivesSymmetryOnly) {
    const Pose pose = random_pose(10);
    const Pose off = turn(kAxis.unitOrthogonal(), 0.1, kCenter);  // tilts the axis
    const Pose step = turn(kAxis, 2.0 * kPi / 3.0, kCenter);
    const PoseDifference tilted = symmetric_difference(three_fold(), pose * off * step, pose);
    EXPECT_NEAR(tilted.angle, 0.1, 1e-9);
    EXPECT_NEAR(tilted.shift, 0.0, 1e-9);
    Pose shifted = pose * step;
    shifted.pretranslate(Eigen::Vector3d(0.3, 0.0, 0.4));
    EXPECT_NEAR(symmetric_difference(three_fold(), shifted, pose).shift, 0.5, 1e-9);
    EXPECT_NEAR(symmetric_difference(three_fold(), shifted, pose).angle, 0.0, 1e-9);
    EXPECT_NEAR(symmetric_difference({}, pose * step, pose).angle, 2.0 * kPi / 3.0, 1e-9);
    // Which of the two is turned doesn't matter.
    const Pose other = random_pose(11);
    EXPECT_NEAR(symmetric_difference(cylinder(), pose, other).angle,
                symmetric_difference(cylinder(), other, pose).angle, 1e-9);
}

TEST(SymmetryCenter, IsWhatNothingMoves) {
    EXPECT_LT((symmetry_center(cylinder().turns, cylinder().axes) - kCenter).norm(), 1e-9);
    EXPECT_EQ(symmetry_center({}, {}), Vec3d::Zero());
    const Vec3d on_axis = symmetry_center(three_fold().turns, {});
    EXPECT_LT((on_axis - kCenter).cross(kAxis).norm(), 1e-9);
    EXPECT_NEAR(on_axis.dot(kAxis), 0.0, 1e-9);
}

TEST(SymmetryName, SaysWhatUsersSay) {
    EXPECT_EQ(symmetry_name({}), "C1");
    EXPECT_EQ(describe_symmetry({}), "none");
    Symmetry hexagon;
    for (int k = 1; k < 6; ++k) {
        hexagon.turns.push_back(turn(-Vec3d::UnitZ(), kPi / 3.0 * k, kCenter));
    }
    EXPECT_EQ(symmetry_name(hexagon), "C6");
    EXPECT_EQ(describe_symmetry(hexagon), "6-fold about (0 0 1)");
    for (int k = 0; k < 6; ++k) {
        const Vec3d axis(std::cos(kPi / 6.0 * k), std::sin(kPi / 6.0 * k), 0.0);
        hexagon.turns.push_back(turn(axis, kPi, kCenter));
    }
    EXPECT_EQ(symmetry_name(hexagon), "D6");
    EXPECT_EQ(describe_symmetry(hexagon), "6-fold about (0 0 1), and 6 half turns across");
    EXPECT_EQ(symmetry_name(cylinder()), "D-infinity");
    EXPECT_EQ(describe_symmetry({.axes = {{Vec3d::UnitX(), kCenter}}}), "continuous about (1 0 0)");
    EXPECT_EQ(symmetry_name({.axes = {{Vec3d::UnitX(), kCenter}}}), "C-infinity");
    EXPECT_EQ(symmetry_name(ball()), "sphere");
    Symmetry odd;
    for (int k = 1; k < 4; ++k) odd.turns.push_back(turn(kAxis, 0.3 * k, kCenter));
    odd.turns.push_back(turn(kAxis.unitOrthogonal(), 1.0, kCenter));
    EXPECT_EQ(symmetry_name(odd), "other");
}

}  // namespace
}  // namespace ostraka
