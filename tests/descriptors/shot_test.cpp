// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/shot.hpp"

#include <gtest/gtest.h>

#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

std::vector<Vec3f> some_keypoints(const PointCloud& cloud) {
    std::vector<Vec3f> keypoints;
    for (std::size_t i = 0; i < cloud.size(); i += 25) keypoints.push_back(cloud.points[i]);
    return keypoints;
}

TEST(Shot, RowsHaveUnitLengthAndFramesAreRotations) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(2'000);
    const auto keypoints = some_keypoints(cloud);
    const auto result = describe_shot(cloud, KdTree(cloud.points), keypoints, {.radius = 15.0F});
    ASSERT_EQ(result.rows.size(), keypoints.size() * kShotLength);
    ASSERT_EQ(result.frames.size(), keypoints.size());
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
        double squares = 0.0;
        for (std::size_t i = 0; i < kShotLength; ++i) {
            const float value = result.rows[k * kShotLength + i];
            EXPECT_GE(value, 0.0F);
            squares += double{value} * value;
        }
        EXPECT_NEAR(squares, 1.0, 1e-5);
        const Mat3f& R = result.frames[k];
        EXPECT_LE((R * R.transpose() - Mat3f::Identity()).norm(), 1e-5F);
        EXPECT_GT(R.determinant(), 0.0F);
    }
}

TEST(Shot, LocalRowsAndFramesMoveWithTheCloud) {
    const PointCloud cloud = shapes::cut_torus(3'000);
    Pose T_b_a = Pose::Identity();
    T_b_a.linear() = Random(8).rotation();
    T_b_a.translation() = Vec3d(5.0, 6.0, -7.0);
    const PointCloud moved = transformed(cloud, T_b_a);
    const ShotSettings settings{.radius = 12.0F};
    const auto a = describe_shot(cloud, KdTree(cloud.points), some_keypoints(cloud), settings);
    const auto b = describe_shot(moved, KdTree(moved.points), some_keypoints(moved), settings);
    std::size_t different = 0;
    for (std::size_t k = 0; k < a.frames.size(); ++k) {
        const std::span<const float> row_a(a.rows.data() + k * kShotLength, kShotLength);
        const std::span<const float> row_b(b.rows.data() + k * kShotLength, kShotLength);
        const Mat3f R = T_b_a.linear().cast<float>();
        const bool same = shapes::relative_l1(row_b, row_a) <= 2e-3 &&
                          (b.frames[k] * R - a.frames[k]).norm() <= 1e-3F;
        if (!same) ++different;
    }
    // Where the majority hangs on one point, rounding may turn an axis.
    EXPECT_LE(different, a.frames.size() / 50);
}

TEST(Shot, KeypointsWithoutSupportGetZerosAndNoFrame) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(500);
    const std::vector<Vec3f> keypoints = {Vec3f(1000.0F, 0.0F, 0.0F), cloud.points[0]};
    const auto result = describe_shot(cloud, KdTree(cloud.points), keypoints, {.radius = 20.0F});
    for (std::size_t i = 0; i < kShotLength; ++i) EXPECT_EQ(result.rows[i], 0.0F);
    EXPECT_TRUE(result.frames[0].array().isNaN().all());
    EXPECT_TRUE(result.frames[1].allFinite());
}

TEST(Shot, ThreadCountAndOrderOfThePointsChangeNoBit) {
    const PointCloud cloud = shapes::notched_box(1'500);
    const auto keypoints = some_keypoints(cloud);
    set_thread_count(1);
    const auto one = describe_shot(cloud, KdTree(cloud.points), keypoints, {.radius = 15.0F});
    set_thread_count(0);
    const auto many = describe_shot(cloud, KdTree(cloud.points), keypoints, {.radius = 15.0F});
    EXPECT_EQ(many.rows, one.rows);
    PointCloud reversed = cloud;
    std::reverse(reversed.points.begin(), reversed.points.end());
    std::reverse(reversed.normals.begin(), reversed.normals.end());
    const auto other =
        describe_shot(reversed, KdTree(reversed.points), keypoints, {.radius = 15.0F});
    EXPECT_EQ(other.rows, one.rows);
}

TEST(Shot, TreeIsNotNeeded) {
    const PointCloud cloud = shapes::cut_torus(700);
    const auto keypoints = some_keypoints(cloud);
    const auto with = describe_shot(cloud, KdTree(cloud.points), keypoints, {.radius = 9.0F});
    const auto without = describe_shot(cloud, keypoints, {.radius = 9.0F});
    EXPECT_EQ(with.rows, without.rows);
}

TEST(Shot, BadArgumentsAreRejected) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(50);
    const KdTree tree(cloud.points);
    EXPECT_THROW(describe_shot(cloud, tree, cloud.points, {}), InvalidInput);
    EXPECT_THROW(describe_shot(cloud, tree, cloud.points, {.radius = -1.0F}), InvalidInput);
    const KdTree other(std::span(cloud.points).first(20));
    EXPECT_THROW(describe_shot(cloud, other, cloud.points, {.radius = 1.0F}), InvalidInput);
    PointCloud bare = cloud;
    bare.normals.clear();
    EXPECT_THROW(describe_shot(bare, tree, cloud.points, {.radius = 1.0F}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
