// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/gasd.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/cloud/principal_frame.hpp"

namespace ostraka {
namespace {

TEST(Gasd, FrameOfABarIsItsAxes) {
    // 5 x 3 x 1 with more points at positive x; seen from +z.
    PointCloud cloud;
    for (int i = 0; i <= 10; ++i) {
        for (int j = -3; j <= 3; ++j) {
            for (int k = -1; k <= 1; ++k) {
                cloud.points.emplace_back(5.0F - 0.1F * static_cast<float>(i * i),
                                          0.5F * static_cast<float>(j),
                                          0.2F * static_cast<float>(k));
            }
        }
    }
    cloud.viewpoint = Vec3f(0.0F, 0.0F, 50.0F);
    const GasdFrame frame = gasd_frame(cloud);
    // The tail is at negative x, so that is where the cubes are largest.
    Mat3d expected;
    expected << -1, 0, 0, 0, -1, 0, 0, 0, 1;
    EXPECT_LE((frame.R_aligned_cloud - expected).norm(), 1e-6);
    EXPECT_GT(frame.x_skewness, 0.1);
    EXPECT_LE((gasd_pose(frame) * frame.centroid).norm(), 1e-12);
}

TEST(Gasd, FrameMovesWithTheCloud) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(2'000);
    Pose T_b_a = Pose::Identity();
    T_b_a.linear() = Random(3).rotation();
    T_b_a.translation() = Vec3d(10.0, -20.0, 30.0);
    const Pose T_aligned_a = gasd_pose(gasd_frame(cloud));
    const Pose T_aligned_b = gasd_pose(gasd_frame(transformed(cloud, T_b_a)));
    const Pose found = T_aligned_b.inverse() * T_aligned_a;
    EXPECT_LE((found.matrix() - T_b_a.matrix()).norm(), 1e-3);
    EXPECT_NEAR(T_aligned_a.linear().determinant(), 1.0, 1e-12);
}

// Which is why hypotheses from segments need no other frames for it.
TEST(Gasd, FrameIsThePrincipalFrame) {
    for (const PointCloud& cloud :
         {shapes::bumpy_ellipsoid(2'000), shapes::cut_torus(1'000), shapes::cut_torus(3'000)}) {
        const Pose principal = principal_frame(cloud).T_cloud_frame;
        const Pose gasd = gasd_pose(gasd_frame(cloud)).inverse(Eigen::Isometry);
        EXPECT_LE((principal.matrix() - gasd.matrix()).norm(), 1e-5);
    }
}

TEST(Gasd, EveryPointCountsWhenAsked) {
    const PointCloud cloud = shapes::cut_torus(1'000);
    GasdSettings settings;
    settings.outer_half_only = false;
    const auto all = describe_gasd(cloud, settings);
    const auto outer = describe_gasd(cloud);
    // Interpolation spills a little over the border of the grid.
    const double sum = std::accumulate(all.begin(), all.end(), 0.0);
    EXPECT_GT(sum, 95.0);
    EXPECT_LE(sum, 100.0 * 1000.0 / 999.0 + 1e-4);
    for (std::size_t i = 0; i < kGasdLength; ++i) EXPECT_LE(outer[i], all[i] + 1e-6F);
}

TEST(Gasd, PointsAtTheCellCentersFillTheirCells) {
    // With the largest coordinate at 4 a cell is 1 wide. Points at (+-3.5, +-1.5, 0.5) and (+-4, 0,
    // 0).
    PointCloud cloud;
    cloud.points = {{3.5F, 1.5F, 0.5F},   {3.5F, -1.5F, -0.5F}, {-3.5F, 1.5F, -0.5F},
                    {-3.5F, -1.5F, 0.5F}, {4.0F, 0.0F, 0.0F},   {-4.0F, 0.0F, 0.0F}};
    GasdFrame frame;
    GasdSettings settings;
    settings.outer_half_only = false;
    const auto row = describe_gasd(cloud, frame, settings);
    const auto cell = [&](int x, int y, int z) {
        return row[static_cast<std::size_t>((x * 8 + y) * 8 + z)];
    };
    const float share = 100.0F / 5.0F;
    EXPECT_NEAR(cell(7, 5, 4), share, 1e-3F);
    EXPECT_NEAR(cell(7, 2, 3), share, 1e-3F);
    EXPECT_NEAR(cell(0, 5, 3), share, 1e-3F);
    EXPECT_NEAR(cell(0, 2, 4), share, 1e-3F);
    EXPECT_NEAR(cell(7, 3, 3), share / 8.0F, 1e-3F);  // half of it lies beyond the border
}

TEST(Gasd, EmptyCloudsAreRejected) {
    EXPECT_THROW(gasd_frame({}), InvalidInput);
    EXPECT_THROW(describe_gasd({}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
