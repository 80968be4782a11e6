// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/spin_image.hpp"

#include <gtest/gtest.h>

#include "descriptors/local_testing.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kLength = spin_image_length({});
static_assert(kLength == 153);

std::vector<float> rows_of(const PointCloud& cloud, std::span<const Vec3f> keypoints,
                           const SpinImageSettings& settings) {
    return describe_spin_images(cloud, KdTree(cloud.points), keypoints, settings).rows;
}

TEST(SpinImage, RowsSumToOne) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(1'500);
    const auto keypoints = shapes::some_keypoints(cloud, 20);
    const KdTree tree(cloud.points);
    const auto result = describe_spin_images(cloud, tree, keypoints, {.radius = 15.0F});
    ASSERT_EQ(result.rows.size(), keypoints.size() * kLength);
    EXPECT_TRUE(result.frames.empty());
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
        double sum = 0.0;
        for (std::size_t i = 0; i < kLength; ++i) sum += result.rows[k * kLength + i];
        EXPECT_NEAR(sum, 1.0, 1e-5);
    }
}

// One point at a known place is shared by the four bins around it.
TEST(SpinImage, APointIsSharedByFourBins) {
    PointCloud cloud;
    cloud.points = {{0.0F, 0.0F, 0.0F}, {0.0F, 2.25F, 1.5F}};
    cloud.normals = {{0.0F, 0.0F, 1.0F}, {0.0F, 1.0F, 0.0F}};
    const auto radius = static_cast<float>(4.0 * std::sqrt(2.0));  // bins of side 1
    const SpinImageSettings settings{.radius = radius, .width = 4};
    const auto row = rows_of(cloud, std::span(cloud.points).first(1), settings);
    ASSERT_EQ(row.size(), 45U);
    std::vector<float> expected(45, 0.0F);
    expected[2 * 9 + 4 + 1] = 0.75F * 0.5F;
    expected[2 * 9 + 4 + 2] = 0.75F * 0.5F;
    expected[3 * 9 + 4 + 1] = 0.25F * 0.5F;
    expected[3 * 9 + 4 + 2] = 0.25F * 0.5F;
    for (std::size_t i = 0; i < row.size(); ++i) EXPECT_NEAR(row[i], expected[i], 1e-6F) << i;
    // Its normal is perpendicular to the axis.
    const SpinImageSettings strict{.radius = radius, .width = 4, .support_cosine = 0.5F};
    EXPECT_EQ(rows_of(cloud, std::span(cloud.points).first(1), strict),
              std::vector<float>(45, 0.0F));
}

TEST(SpinImage, APlaneStaysInItsLine) {
    const PointCloud cloud = shapes::plane(20);
    const auto rows = rows_of(cloud, cloud.points, {.radius = 5.0F});
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (i % 17 != 8) {
            EXPECT_EQ(rows[i], 0.0F);
        }
    }
}

TEST(SpinImage, TurningAroundTheAxisChangesNothing) {
    const PointCloud cloud = shapes::cut_torus(1'500);
    const SpinImageSettings settings{.radius = 15.0F, .support_cosine = 0.3F};
    for (const std::size_t k : {0U, 500U, 1'000U}) {
        Pose T_b_a = Pose::Identity();
        T_b_a.rotate(Eigen::AngleAxisd(1.0, cloud.normals[k].cast<double>().normalized()));
        PointCloud turned = transformed(cloud, T_b_a);
        const std::vector<Vec3f> a = {cloud.points[k]};
        const std::vector<Vec3f> b = {turned.points[k]};
        EXPECT_LE(shapes::relative_l1(rows_of(turned, b, settings), rows_of(cloud, a, settings)),
                  1e-3);
    }
}

TEST(SpinImage, RowsStayUnderMotionAndScale) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(2'000);
    const PointCloud moved = transformed(cloud, shapes::some_motion());
    const auto rows = rows_of(cloud, cloud.points, {.radius = 12.0F});
    const auto moved_rows = rows_of(moved, moved.points, {.radius = 12.0F});
    // Bins are interpolated, so that rounding can't move a point's vote.
    EXPECT_EQ(shapes::different_rows(rows, moved_rows, kLength, 5e-3), 0U);
    const PointCloud larger = scaled(cloud, 256.0);
    EXPECT_EQ(rows_of(larger, larger.points, {.radius = 12.0F * 256.0F}), rows);
}

TEST(SpinImage, ThreadCountAndOrderOfThePointsChangeNoBit) {
    const PointCloud cloud = shapes::notched_box(1'500);
    const auto keypoints = shapes::some_keypoints(cloud, 20);
    set_thread_count(1);
    const auto one = rows_of(cloud, keypoints, {.radius = 15.0F});
    set_thread_count(4);
    EXPECT_EQ(rows_of(cloud, keypoints, {.radius = 15.0F}), one);
    set_thread_count(0);
    EXPECT_EQ(rows_of(shapes::shuffled(cloud), keypoints, {.radius = 15.0F}), one);
    const KdTree tree(cloud.points);
    const auto all = rows_of(cloud, cloud.points, {.radius = 8.0F});
    EXPECT_EQ(describe_spin_images(cloud, cloud.points, cloud.normals, {.radius = 8.0F}).rows, all);
    EXPECT_EQ(describe_spin_images(cloud, tree, cloud.points, cloud.normals, {.radius = 8.0F}).rows,
              all);
}

TEST(SpinImage, OddCloudsGiveFiniteRows) {
    for (const PointCloud& cloud : shapes::odd_clouds()) {
        for (const float radius : {1e-6F, 1.5F, 1e6F}) {
            for (const float cosine : {0.0F, 0.5F}) {
                for (const float value :
                     rows_of(cloud, cloud.points, {.radius = radius, .support_cosine = cosine})) {
                    EXPECT_TRUE(std::isfinite(value) && value >= 0.0F && value <= 1.0F);
                }
            }
        }
    }
    const PointCloud cloud = shapes::bumpy_ellipsoid(300);
    const std::vector<Vec3f> away = {Vec3f(1000.0F, 0.0F, 0.0F)};
    EXPECT_EQ(rows_of(cloud, away, {.radius = 5.0F}), std::vector<float>(kLength, 0.0F));
}

TEST(SpinImage, BadArgumentsAreRejected) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(50);
    EXPECT_THROW(rows_of(cloud, cloud.points, {}), InvalidInput);
    EXPECT_THROW(rows_of(cloud, cloud.points, {.radius = 1.0F, .width = 0}), InvalidInput);
    EXPECT_THROW(rows_of(cloud, cloud.points, {.radius = 1.0F, .width = 65}), InvalidInput);
    EXPECT_THROW(rows_of(cloud, cloud.points, {.radius = 1.0F, .support_cosine = 1.5F}),
                 InvalidInput);
    const auto axes = std::span(cloud.normals).first(20);
    EXPECT_THROW(describe_spin_images(cloud, cloud.points, axes, {.radius = 1.0F}), InvalidInput);
    PointCloud bare = cloud;
    bare.normals.clear();
    EXPECT_THROW(rows_of(bare, cloud.points, {.radius = 1.0F}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
