// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/fpfh.hpp"

#include <gtest/gtest.h>

#include "descriptors/local_testing.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

std::span<const float> row_of(const LocalDescriptors& result, std::size_t k) {
    return std::span(result.rows).subspan(k * kFpfhLength, kFpfhLength);
}

TEST(Fpfh, EachAngleSumsToHundred) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(1'500);
    const auto keypoints = shapes::some_keypoints(cloud, 10);
    const auto result = describe_fpfh(cloud, keypoints, {.radius = 12.0F});
    ASSERT_EQ(result.rows.size(), keypoints.size() * kFpfhLength);
    EXPECT_TRUE(result.frames.empty());
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
        for (std::size_t angle = 0; angle < 3; ++angle) {
            double sum = 0.0;
            for (const float value : row_of(result, k).subspan(11 * angle, 11)) {
                EXPECT_GE(value, 0.0F);
                sum += value;
            }
            EXPECT_NEAR(sum, 100.0, 1e-3);
        }
    }
}

TEST(Fpfh, APlaneFillsTheMiddleBins) {
    const PointCloud cloud = shapes::plane(20);
    const auto result = describe_fpfh(cloud, {.radius = 4.0F});
    for (std::size_t k = 0; k < cloud.size(); ++k) {
        for (std::size_t b = 0; b < kFpfhLength; ++b) {
            EXPECT_FLOAT_EQ(row_of(result, k)[b], b % 11 == 5 ? 100.0F : 0.0F);
        }
    }
}

// On a sphere every pair has the same triangle but for its size: with the chord d and the radius r,
// the normal and the line are at cosine d / 2r, the axis across is perpendicular to both normals,
// and the angle around the first normal is the arc's.
TEST(Fpfh, ASphereHasKnownAngles) {
    PointCloud cloud;
    Random random(3);
    for (int i = 0; i < 4'000; ++i) {
        const Vec3d d = random.direction();
        cloud.points.push_back((10.0 * d).cast<float>());
        cloud.normals.push_back(d.cast<float>());
    }
    const float radius = 1.5F;
    // The largest angles are 2 asin(0.075) = 8.6 degrees and 94.3 degrees: all in middle bins.
    const auto near = describe_fpfh(cloud, {.radius = radius});
    for (std::size_t k = 0; k < cloud.size(); k += 50) {
        EXPECT_NEAR(row_of(near, k)[5], 100.0F, 1e-3F);
        EXPECT_NEAR(row_of(near, k)[16], 100.0F, 1e-3F);
        EXPECT_NEAR(row_of(near, k)[27], 100.0F, 1e-3F);
    }
    // With chords up to 6, those beyond 20 / 11 lie one bin lower along the line, those beyond
    // 20 * 3 / 11 two; the share of chords below c on a sphere goes with c squared.
    const auto far = describe_fpfh(cloud, {.radius = 6.0F});
    std::array<double, kFpfhLength> mean{};
    for (std::size_t i = 0; i < far.rows.size(); ++i) {
        mean[i % kFpfhLength] += far.rows[i] / static_cast<double>(cloud.size());
    }
    const double one = std::pow(20.0 / 11.0 / 6.0, 2.0);
    const double two = 1.0 - std::pow(60.0 / 11.0 / 6.0, 2.0);
    EXPECT_NEAR(mean[27], 100.0 * one, 0.5);
    EXPECT_NEAR(mean[26], 100.0 * (1.0 - one - two), 0.5);
    EXPECT_NEAR(mean[25], 100.0 * two, 0.5);
    EXPECT_NEAR(mean[16], 100.0, 1e-2);
}

TEST(Fpfh, AllPointsGetTheRowsOfKeypoints) {
    PointCloud cloud = shapes::cut_torus(1'200);
    cloud.normals[7] = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
    for (const bool paper : {false, true}) {
        const FpfhSettings settings{.radius = 9.0F, .paper_weights = paper};
        const auto everywhere = describe_fpfh(cloud, settings);
        const auto keypoints = describe_fpfh(cloud, cloud.points, settings);
        EXPECT_EQ(everywhere.rows, keypoints.rows);
        const KdTree tree(cloud.points);
        EXPECT_EQ(describe_fpfh(cloud, tree, cloud.points, settings).rows, keypoints.rows);
        EXPECT_GT(row_of(everywhere, 7)[5], 0.0F);  // from its neighbors
    }
}

TEST(Fpfh, RowsStayUnderMotionAndScale) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(2'000);
    const auto rows = describe_fpfh(cloud, {.radius = 10.0F}).rows;
    const PointCloud moved = transformed(cloud, shapes::some_motion());
    const auto moved_rows = describe_fpfh(moved, {.radius = 10.0F}).rows;
    EXPECT_LE(shapes::different_rows(rows, moved_rows, kFpfhLength, 5e-3), cloud.size() / 100);
    const PointCloud larger = scaled(cloud, 1024.0);
    EXPECT_EQ(describe_fpfh(larger, {.radius = 10240.0F}).rows, rows);
}

TEST(Fpfh, ThreadCountAndOrderOfThePointsChangeNoBit) {
    const PointCloud cloud = shapes::notched_box(1'500);
    const auto keypoints = shapes::some_keypoints(cloud, 20);
    set_thread_count(1);
    const auto one = describe_fpfh(cloud, keypoints, {.radius = 10.0F});
    const auto one_all = describe_fpfh(cloud, {.radius = 10.0F});
    set_thread_count(4);
    EXPECT_EQ(describe_fpfh(cloud, keypoints, {.radius = 10.0F}).rows, one.rows);
    EXPECT_EQ(describe_fpfh(cloud, {.radius = 10.0F}).rows, one_all.rows);
    set_thread_count(0);
    EXPECT_EQ(describe_fpfh(shapes::shuffled(cloud), keypoints, {.radius = 10.0F}).rows, one.rows);
}

TEST(Fpfh, OddCloudsGiveFiniteRows) {
    for (const PointCloud& cloud : shapes::odd_clouds()) {
        for (const float radius : {1e-6F, 1.5F, 1e6F}) {
            for (const float value : describe_fpfh(cloud, {.radius = radius}).rows) {
                EXPECT_TRUE(std::isfinite(value) && value >= 0.0F && value <= 100.01F);
            }
        }
    }
    EXPECT_TRUE(describe_fpfh(PointCloud{}, {.radius = 1.0F}).rows.empty());
}

TEST(Fpfh, KeypointsWithoutNeighborsGetZeros) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(500);
    const std::vector<Vec3f> keypoints = {Vec3f(1000.0F, 0.0F, 0.0F), cloud.points[0],
                                          Vec3f(0.1F, 0.2F, 0.3F)};
    const auto result = describe_fpfh(cloud, keypoints, {.radius = 8.0F});
    EXPECT_EQ(std::count(result.rows.begin(), result.rows.begin() + kFpfhLength, 0.0F), 33);
    EXPECT_GT(*std::max_element(row_of(result, 1).begin(), row_of(result, 1).end()), 0.0F);
}

// With one neighbor there is one pair: both histograms are that pair's, so the weights don't
// matter.
TEST(Fpfh, PaperWeightsIncludeThePointItself) {
    PointCloud cloud = shapes::bumpy_ellipsoid(400);
    const auto pcl = describe_fpfh(cloud, {.radius = 15.0F});
    const auto paper = describe_fpfh(cloud, {.radius = 15.0F, .paper_weights = true});
    EXPECT_GT(shapes::relative_l1(paper.rows, pcl.rows), 0.01);
    const std::vector<std::uint32_t> two = {0, 1};
    cloud = select(cloud, two);
    const float radius = 2.0F * (cloud.points[0] - cloud.points[1]).norm();
    const auto a = describe_fpfh(cloud, {.radius = radius});
    const auto b = describe_fpfh(cloud, {.radius = radius, .paper_weights = true});
    EXPECT_EQ(a.rows, b.rows);
    EXPECT_EQ(std::count(a.rows.begin(), a.rows.end(), 100.0F), 6);
}

TEST(Fpfh, BadArgumentsAreRejected) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(50);
    const KdTree other(std::span(cloud.points).first(20));
    EXPECT_THROW(describe_fpfh(cloud, cloud.points, {}), InvalidInput);
    EXPECT_THROW(describe_fpfh(cloud, {.radius = -1.0F}), InvalidInput);
    EXPECT_THROW(describe_fpfh(cloud, other, cloud.points, {.radius = 1.0F}), InvalidInput);
    PointCloud bare = cloud;
    bare.normals.clear();
    EXPECT_THROW(describe_fpfh(bare, {.radius = 1.0F}), InvalidInput);
    PointCloud holes = cloud;
    holes.points[3].x() = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(describe_fpfh(holes, {.radius = 1.0F}), InvalidInput);
    const std::vector<Vec3f> bad = {Vec3f::Constant(std::numeric_limits<float>::infinity())};
    EXPECT_THROW(describe_fpfh(cloud, bad, {.radius = 1.0F}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
