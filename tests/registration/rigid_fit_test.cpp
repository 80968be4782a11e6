// SPDX-License-Identifier: Apache-2.0
#include "ostraka/registration/rigid_fit.hpp"

#include <gtest/gtest.h>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

std::vector<Vec3f> moved(const std::vector<Vec3f>& points, const Pose& T_target_source) {
    std::vector<Vec3f> result;
    for (const Vec3f& point : points) {
        result.push_back((T_target_source * point.cast<double>()).cast<float>());
    }
    return result;
}

double cost(const std::vector<Vec3f>& source, const std::vector<Vec3f>& target,
            const Pose& T_target_source) {
    double sum = 0.0;
    for (std::size_t i = 0; i < source.size(); ++i) {
        const Vec3d at = T_target_source * source[i].cast<double>();
        sum += (target[i].cast<double>() - at).squaredNorm();
    }
    return sum;
}

void expect_rigid(const Pose& pose) {
    const Mat3d R = pose.linear();
    EXPECT_LT((R * R.transpose() - Mat3d::Identity()).norm(), 1e-9);
    EXPECT_NEAR(R.determinant(), 1.0, 1e-9);
}

TEST(FitRigid, FindsTheMotionOfNoiseFreePairs) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const std::size_t count = seed < 25 ? 3 : 40;
        const std::vector<Vec3f> source = test_clouds::in_box(count, seed);
        const Pose pose = test_clouds::random_pose(seed + 100);
        const Pose found = fit_rigid(source, moved(source, pose));
        expect_rigid(found);
        EXPECT_LT((found.matrix() - pose.matrix()).norm(), 2e-5);
    }
}

TEST(FitRigid, ThereAndBackAreInverse) {
    const std::vector<Vec3f> source = test_clouds::in_box(30, 1);
    std::vector<Vec3f> target = moved(source, test_clouds::random_pose(2));
    Random random(3);
    for (Vec3f& point : target) point += Vec3d(0.05 * random.direction()).cast<float>();
    const Pose there = fit_rigid(source, target);
    const Pose back = fit_rigid(target, source);
    EXPECT_LT(((there * back).matrix() - Mat4d::Identity()).norm(), 1e-9);
}

TEST(FitRigid, NoSmallMotionIsBetter) {
    const std::vector<Vec3f> source = test_clouds::in_box(30, 4);
    std::vector<Vec3f> target = moved(source, test_clouds::random_pose(5));
    Random random(6);
    for (Vec3f& point : target) point += Vec3d(0.3 * random.direction()).cast<float>();
    const Pose best = fit_rigid(source, target);
    const double least = cost(source, target, best);
    for (int trial = 0; trial < 200; ++trial) {
        Pose other = best;
        other.translate(Eigen::Vector3d(1e-3 * random.direction()));
        other.rotate(
            Eigen::AngleAxisd(1e-3 * random.normal(), Eigen::Vector3d(random.direction())));
        EXPECT_GT(cost(source, target, other), least);
    }
}

TEST(FitRigid, NeverGivesAReflection) {
    const std::vector<Vec3f> source = test_clouds::in_box(50, 7, {3.0, 2.0, 1.0});
    std::vector<Vec3f> mirrored = source;
    for (Vec3f& point : mirrored) point.z() = -point.z();
    expect_rigid(fit_rigid(source, mirrored));
    // Flat sets leave the reflection open.
    const std::vector<Vec3f> flat = test_clouds::in_box(50, 8, {1.0, 1.0, 0.0});
    const Pose pose = test_clouds::random_pose(9);
    const Pose found = fit_rigid(flat, moved(flat, pose));
    expect_rigid(found);
    EXPECT_LT((found.matrix() - pose.matrix()).norm(), 2e-5);
}

TEST(FitRigid, WeightsCountLikeCopies) {
    const std::vector<Vec3f> source = test_clouds::in_box(10, 10);
    const std::vector<Vec3f> target = test_clouds::in_box(10, 11);
    std::vector<Vec3f> source_copies = source;
    std::vector<Vec3f> target_copies = target;
    source_copies.insert(source_copies.end(), 2, source[3]);
    target_copies.insert(target_copies.end(), 2, target[3]);
    std::vector<float> weights(10, 1.0F);
    weights[3] = 3.0F;
    const Pose weighted = fit_rigid(source, target, weights);
    EXPECT_LT((weighted.matrix() - fit_rigid(source_copies, target_copies).matrix()).norm(), 1e-6);
}

TEST(FitRigid, ZeroWeightsHideOutliers) {
    const std::vector<Vec3f> source = test_clouds::in_box(20, 12);
    const Pose pose = test_clouds::random_pose(13);
    std::vector<Vec3f> target = moved(source, pose);
    std::vector<float> weights(20, 0.7F);
    for (const std::size_t i : {2U, 9U, 15U}) {
        target[i] += Vec3f(50, -20, 30);
        weights[i] = 0.0F;
    }
    EXPECT_LT((fit_rigid(source, target, weights).matrix() - pose.matrix()).norm(), 2e-5);
}

TEST(FitRigid, FewerThanThreePairsGiveOneOfTheBest) {
    const std::vector<Vec3f> one = {{1, 2, 3}};
    const std::vector<Vec3f> other = {{4, 6, 8}};
    const Pose shift = fit_rigid(one, other);
    expect_rigid(shift);
    EXPECT_NEAR(cost(one, other, shift), 0.0, 1e-9);
    const std::vector<Vec3f> source = {{0, 0, 0}, {2, 0, 0}};
    const std::vector<Vec3f> target = {{1, 1, 1}, {1, 3, 1}};
    const Pose pair = fit_rigid(source, target);
    expect_rigid(pair);
    EXPECT_NEAR(cost(source, target, pair), 0.0, 1e-9);
}

TEST(FitRigid, RejectsUnusableInput) {
    const std::vector<Vec3f> three = test_clouds::in_box(3, 1);
    const std::vector<Vec3f> two = test_clouds::in_box(2, 1);
    EXPECT_THROW(fit_rigid({}, {}), InvalidInput);
    EXPECT_THROW(fit_rigid(three, two), InvalidInput);
    EXPECT_THROW(fit_rigid(three, three, std::vector<float>{1.0F}), InvalidInput);
    EXPECT_THROW(fit_rigid(three, three, std::vector<float>(3, 0.0F)), InvalidInput);
}

}  // namespace
}  // namespace ostraka
