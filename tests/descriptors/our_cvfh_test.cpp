// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/our_cvfh.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/our_cvfh_frames.hpp"

namespace ostraka {
namespace {

Pose some_motion() {
    Pose motion = Pose::Identity();
    motion.linear() = Random(4).rotation();
    motion.translation() = Vec3d(-10.0, 25.0, 30.0);
    return motion;
}

// A flat plate of 80 x 40; with a wall of 30 on its far side if asked for.
PointCloud plate(bool with_wall) {
    PointCloud cloud;
    for (int j = -20; j <= 20; ++j) {
        for (int i = -40; i <= 40; ++i) {
            cloud.points.emplace_back(static_cast<float>(i), static_cast<float>(j), 0.0F);
            cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
        }
        for (int k = 1; with_wall && k <= 30; ++k) {
            cloud.points.emplace_back(40.0F, static_cast<float>(j), static_cast<float>(k));
            cloud.normals.emplace_back(-1.0F, 0.0F, 0.0F);
        }
    }
    cloud.viewpoint = Vec3f(-200, 0, 300);
    return cloud;
}

TEST(OurCvfh, FramesStandOnTheirRegions) {
    const PointCloud cloud = shapes::notched_box(5'000);
    const auto result = describe_our_cvfh(cloud);
    ASSERT_GE(result.regions.size(), 3U);
    ASSERT_EQ(result.T_frame_cloud.size(), result.region_of_row.size());
    ASSERT_EQ(result.rows.size(), result.region_of_row.size() * kOurCvfhLength);
    for (std::size_t row = 0; row < result.region_of_row.size(); ++row) {
        const SmoothRegion& region = result.regions[result.region_of_row[row]];
        const Pose& T_frame_cloud = result.T_frame_cloud[row];
        EXPECT_LE((T_frame_cloud * region.centroid.cast<double>()).norm(), 1e-9);
        EXPECT_NEAR(T_frame_cloud.linear().determinant(), 1.0, 1e-9);
        const Vec3d z = T_frame_cloud.linear().row(2);
        EXPECT_GT(z.dot(region.normal.cast<double>()), 0.999);
    }
}

TEST(OurCvfh, FramesGiveThePose) {
    const Pose T_b_a = some_motion();
    for (const PointCloud& a : {shapes::notched_box(5'000), shapes::cut_torus(5'000)}) {
        const auto in_a = describe_our_cvfh(a);
        const auto in_b = describe_our_cvfh(transformed(a, T_b_a));
        ASSERT_EQ(in_a.region_of_row, in_b.region_of_row);
        double best = 1e9;
        for (std::size_t row = 0; row < in_a.T_frame_cloud.size(); ++row) {
            const Pose found = in_b.T_frame_cloud[row].inverse() * in_a.T_frame_cloud[row];
            best = std::min(best, (found.matrix() - T_b_a.matrix()).norm());
        }
        EXPECT_LE(best, 1e-2);
        EXPECT_LE(shapes::relative_l1(in_b.rows, in_a.rows), 0.02);
    }
}

TEST(OurCvfh, APlateWithEqualSidesGetsFourFrames) {
    const auto result = describe_our_cvfh(plate(false));
    ASSERT_EQ(result.regions.size(), 1U);
    ASSERT_EQ(result.T_frame_cloud.size(), 4U);
    // Each axis with both signs; z toward the viewpoint.
    Vec3d sum = Vec3d::Zero();
    for (const Pose& T_frame_cloud : result.T_frame_cloud) {
        sum += T_frame_cloud.linear().row(0);
        EXPECT_NEAR(T_frame_cloud.linear()(2, 2), 1.0, 1e-6);
    }
    EXPECT_LE(sum.norm(), 1e-9);
}

TEST(OurCvfh, WhatLiesBesideARegionDecidesItsFrame) {
    const auto result = describe_our_cvfh(plate(true));
    ASSERT_EQ(result.regions.size(), 2U);
    ASSERT_EQ(result.T_frame_cloud.size(), 2U);
    // The plate's x points to the wall, the wall's to the plate.
    EXPECT_LE((result.T_frame_cloud[0].linear() - Mat3d::Identity()).norm(), 0.1);
    const Vec3d down = result.T_frame_cloud[1].linear().row(0);
    EXPECT_LE((down - Vec3d(0, 0, -1)).norm(), 0.1);
}

TEST(OurCvfh, FramesOfOneRegionShareAllButTheOctants) {
    const auto result = describe_our_cvfh(shapes::bumpy_ellipsoid(4'000), {.axis_ratio = 0.0F});
    ASSERT_GE(result.T_frame_cloud.size(), 2U);
    ASSERT_EQ(result.region_of_row[0], result.region_of_row[1]);
    const float* a = result.rows.data();
    const float* b = a + kOurCvfhLength;
    EXPECT_TRUE(std::equal(a, a + 135, b));
    EXPECT_TRUE(std::equal(a + 239, a + 308, b + 239));
    EXPECT_FALSE(std::equal(a + 135, a + 239, b + 135));
}

std::vector<float> octants(const PointCloud& cloud, float width, bool normalize = false) {
    std::vector<float> bins(kOctants * kOctantBins);
    octant_distances(cloud, Pose::Identity(), width, normalize, bins);
    return bins;
}

TEST(Octants, HoldThePointsBeyondThePlanesBetweenThem) {
    PointCloud cloud;
    cloud.points = {{6, 6, 6}, {-3, 3, -3}, {3, -3, 3}};
    const auto bins = octants(cloud, 0.01F);
    // x counts 4, a negative y 2, z 1; the farthest point's shell is the last of 13.
    std::vector<float> expected(bins.size(), 0.0F);
    expected[5 * kOctantBins + 12] = 1.0F;
    expected[0 * kOctantBins + 6] = 1.0F;
    expected[7 * kOctantBins + 6] = 1.0F;
    EXPECT_EQ(bins, expected);
}

TEST(Octants, ShareThePointsNearThePlanesBetweenThem) {
    PointCloud cloud;
    cloud.points = {{0, 0, 0}, {1.0F, 40.0F, 40.0F}};
    const auto bins = octants(cloud, 2.0F);
    for (std::size_t o = 0; o < kOctants; ++o) EXPECT_NEAR(bins[o * kOctantBins], 0.125F, 1e-6F);
    // exp(-x^2 / (2 width^2)) at half a width: the own side's share is 1 - exp / 2.
    const float share = 1.0F - 0.5F * std::exp(-0.125F);
    EXPECT_NEAR(bins[5 * kOctantBins + 12], share, 1e-6F);
    EXPECT_NEAR(bins[1 * kOctantBins + 12], 1.0F - share, 1e-6F);
}

TEST(Octants, SumToThePointsWhateverTheWidth) {
    const PointCloud cloud = shapes::cut_torus(2'000);
    for (const float width : {0.0F, 0.01F, 1.0F, 100.0F, 1e9F}) {
        const auto bins = octants(cloud, width);
        EXPECT_NEAR(std::accumulate(bins.begin(), bins.end(), 0.0), 2'000.0, 0.1) << width;
        const auto shared = octants(cloud, width, true);
        EXPECT_NEAR(std::accumulate(shared.begin(), shared.end(), 0.0), 100.05, 0.01) << width;
    }
}

TEST(OurCvfh, ThreadCountChangesNoBit) {
    const PointCloud cloud = shapes::notched_box(5'000);
    set_thread_count(1);
    const auto one = describe_our_cvfh(cloud);
    set_thread_count(0);
    EXPECT_EQ(describe_our_cvfh(cloud).rows, one.rows);
}

TEST(OurCvfh, UnusableInputIsRejected) {
    PointCloud bare = plate(false);
    bare.normals.clear();
    EXPECT_THROW(describe_our_cvfh(bare), InvalidInput);
    EXPECT_THROW(describe_our_cvfh({}), InvalidInput);
    EXPECT_THROW(describe_our_cvfh(plate(false), std::vector<float>(3)), InvalidInput);
}

}  // namespace
}  // namespace ostraka
