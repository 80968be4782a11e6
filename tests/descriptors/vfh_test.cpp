// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/vfh.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

PointCloud square(float viewpoint_height) {
    PointCloud cloud;
    for (int x = 0; x < 20; ++x) {
        for (int y = 0; y < 20; ++y) {
            cloud.points.emplace_back(static_cast<float>(x) - 9.5F, static_cast<float>(y) - 9.5F,
                                      0.0F);
            cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
        }
    }
    cloud.viewpoint = Vec3f(0.0F, 0.0F, viewpoint_height);
    return cloud;
}

double sum(std::span<const float> values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(Vfh, PlaneSeenFrontallyFillsOneBinABlock) {
    const auto row = describe_vfh(square(1000.0F));
    // All angles and cosines are 0, the middle of [-pi, pi]: bin 22 of 45. 400 points at 100 / 399.
    for (std::size_t block = 0; block < 3; ++block) {
        EXPECT_NEAR(row[45 * block + 22], 100.0 * 400.0 / 399.0, 1e-3);
    }
    EXPECT_EQ(sum(std::span(row).subspan(135, 45)), 0.0);  // PCL's distance block is off
    EXPECT_NEAR(row[180 + 127], 100.0, 1e-4);              // normals point at the viewpoint
}

TEST(Vfh, ViewpointBlockCanHavePclsUnit) {
    // At distance 1 PCL divides the direction by sqrt(1 + 1): cosine 0.7071, bin (1.7071 / 2) *
    // 128.
    const auto row = describe_vfh(square(1.0F), {.pcl_viewpoint_length = true});
    EXPECT_NEAR(row[180 + 109], 100.0, 1e-4);
}

TEST(Vfh, TheUnitOfLengthDoesNotMatter) {
    const PointCloud millimeters = shapes::cut_torus(1'000);
    const PointCloud meters = scaled(millimeters, 1.0 / 1024.0);  // exact in floating point
    EXPECT_LT(shapes::relative_l1(describe_vfh(meters), describe_vfh(millimeters)), 2e-3);
}

TEST(Vfh, BlocksSumToTheirShareOfThePoints) {
    const PointCloud cloud = shapes::cut_torus(1'000);
    const std::vector<float> row = describe_vfh(cloud);
    for (std::size_t block = 0; block < 3; ++block) {
        EXPECT_NEAR(sum(std::span(row).subspan(45 * block, 45)), 100.0 * 1000.0 / 999.0, 1e-3);
    }
    EXPECT_NEAR(sum(std::span(row).subspan(180, 128)), 100.0, 1e-3);
}

TEST(Vfh, PointsAtTheCentroidCountForTheViewpointOnly) {
    PointCloud cloud = square(1000.0F);
    cloud.points.emplace_back(0.0F, 0.0F, 0.0F);
    cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
    const auto row = describe_vfh(cloud);
    EXPECT_NEAR(row[22], 100.0, 1e-3);  // 400 of 401 points at 100 / 400
    EXPECT_NEAR(row[180 + 127], 100.0, 1e-4);
}

TEST(Vfh, CloudsWithoutNormalsOrPointsAreRejected) {
    EXPECT_THROW(describe_vfh({}), InvalidInput);
    PointCloud bare = square(1.0F);
    bare.normals.clear();
    EXPECT_THROW(describe_vfh(bare), InvalidInput);
}

}  // namespace
}  // namespace ostraka
