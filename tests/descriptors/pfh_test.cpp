// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/pfh.hpp"

#include <gtest/gtest.h>

#include "descriptors/local_testing.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kMiddle = 62;  // 2 + 5 x 2 + 25 x 2

TEST(Pfh, RowsSumToHundred) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(1'500);
    const auto keypoints = shapes::some_keypoints(cloud, 30);
    const auto result = describe_pfh(cloud, keypoints, {.radius = 12.0F});
    ASSERT_EQ(result.rows.size(), keypoints.size() * kPfhLength);
    EXPECT_TRUE(result.frames.empty());
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
        double sum = 0.0;
        for (std::size_t b = 0; b < kPfhLength; ++b) sum += result.rows[k * kPfhLength + b];
        EXPECT_NEAR(sum, 100.0, 1e-3);
    }
}

TEST(Pfh, APlaneFillsTheMiddleBin) {
    const PointCloud cloud = shapes::plane(12);
    const auto result = describe_pfh(cloud, cloud.points, {.radius = 3.0F});
    for (std::size_t i = 0; i < result.rows.size(); ++i) {
        EXPECT_EQ(result.rows[i], i % kPfhLength == kMiddle ? 100.0F : 0.0F);
    }
}

// Four surfels of two perpendicular planes x = 0 and z = 0: two pairs within a plane, which count
// in the middle bin, and four across, worked out by hand.
TEST(Pfh, PairsAcrossAnEdgeCountWhereTheyShould) {
    PointCloud cloud;
    cloud.points = {{1.0F, 0.0F, 0.0F}, {1.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 0.2F}, {0.0F, 1.0F, 0.2F}};
    cloud.normals = {
        {0.0F, 0.0F, 1.0F}, {0.0F, 0.0F, 1.0F}, {1.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}};
    const std::vector<Vec3f> keypoint = {Vec3f(0.5F, 0.5F, 0.1F)};
    const auto row = describe_pfh(cloud, keypoint, {.radius = 5.0F}).rows;
    // The surfels with normal x are closer to the line. From (0, y, 0.2) to (1, y', 0) the cosine
    // along is 1 / sqrt(1.04) = 0.98 for y' = y (bin 4) and 1 / sqrt(2.04) = 0.70 else (bin 4).
    // v = d x u / |d x u| is (0, -0.2, -+dy) / norm; across = v . z: 0, or -+1 / sqrt(1.04).
    // w = u x v; angle = atan2(w . z, 0) with w . z = u_x v_y: -1 (bin 1), or -0.196 (bin 1).
    std::vector<float> expected(kPfhLength, 0.0F);
    expected[kMiddle] = 100.0F * 2.0F / 6.0F;
    expected[1 + 5 * 2 + 25 * 4] = 100.0F * 2.0F / 6.0F;
    expected[1 + 5 * 0 + 25 * 4] = 100.0F / 6.0F;
    expected[1 + 5 * 4 + 25 * 4] = 100.0F / 6.0F;
    for (std::size_t b = 0; b < kPfhLength; ++b) EXPECT_FLOAT_EQ(row[b], expected[b]) << b;
}

TEST(Pfh, RowsStayUnderMotionAndScale) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(1'500);
    const PointCloud moved = transformed(cloud, shapes::some_motion());
    const auto rows = describe_pfh(cloud, cloud.points, {.radius = 8.0F}).rows;
    const auto moved_rows = describe_pfh(moved, moved.points, {.radius = 8.0F}).rows;
    EXPECT_LE(shapes::different_rows(rows, moved_rows, kPfhLength, 1e-2), cloud.size() / 50);
    const PointCloud smaller = scaled(cloud, 1.0 / 1024.0);
    EXPECT_EQ(describe_pfh(smaller, smaller.points, {.radius = 8.0F / 1024.0F}).rows, rows);
}

TEST(Pfh, ThreadCountAndOrderOfThePointsChangeNoBit) {
    const PointCloud cloud = shapes::notched_box(1'000);
    const auto keypoints = shapes::some_keypoints(cloud, 20);
    set_thread_count(1);
    const auto one = describe_pfh(cloud, keypoints, {.radius = 10.0F}).rows;
    set_thread_count(4);
    EXPECT_EQ(describe_pfh(cloud, keypoints, {.radius = 10.0F}).rows, one);
    set_thread_count(0);
    EXPECT_EQ(describe_pfh(shapes::shuffled(cloud), keypoints, {.radius = 10.0F}).rows, one);
    const KdTree tree(cloud.points);
    EXPECT_EQ(describe_pfh(cloud, tree, keypoints, {.radius = 10.0F}).rows, one);
}

TEST(Pfh, OddCloudsGiveFiniteRows) {
    for (const PointCloud& cloud : shapes::odd_clouds()) {
        for (const float radius : {1e-6F, 1.5F, 1e6F}) {
            for (const float v : describe_pfh(cloud, cloud.points, {.radius = radius}).rows) {
                EXPECT_TRUE(std::isfinite(v) && v >= 0.0F && v <= 100.0F);
            }
        }
    }
    const PointCloud cloud = shapes::bumpy_ellipsoid(300);
    const std::vector<Vec3f> away = {Vec3f(1000.0F, 0.0F, 0.0F)};
    const auto row = describe_pfh(cloud, away, {.radius = 5.0F}).rows;
    EXPECT_EQ(row, std::vector<float>(kPfhLength, 0.0F));
}

TEST(Pfh, BadArgumentsAreRejected) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(50);
    const KdTree other(std::span(cloud.points).first(20));
    EXPECT_THROW(describe_pfh(cloud, cloud.points, {}), InvalidInput);
    EXPECT_THROW(describe_pfh(cloud, cloud.points, {.radius = -1.0F}), InvalidInput);
    EXPECT_THROW(describe_pfh(cloud, other, cloud.points, {.radius = 1.0F}), InvalidInput);
    PointCloud bare = cloud;
    bare.normals.clear();
    EXPECT_THROW(describe_pfh(bare, cloud.points, {.radius = 1.0F}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
