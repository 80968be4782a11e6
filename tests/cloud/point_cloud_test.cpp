// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/point_cloud.hpp"

#include <gtest/gtest.h>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

PointCloud full_cloud() {
    PointCloud cloud = test_clouds::sphere(6, 2.0);
    for (std::uint8_t i = 0; i < 6; ++i) cloud.colors.push_back({i, 1, 2});
    cloud.width = 3;
    cloud.height = 2;
    cloud.viewpoint = Vec3f(1, 2, 3);
    return cloud;
}

TEST(PointCloud, CheckAcceptsWhatTheInvariantsAllow) {
    EXPECT_NO_THROW(check({}));
    EXPECT_NO_THROW(check(full_cloud()));
    PointCloud unorganized = full_cloud();
    unorganized.width = unorganized.height = 0;
    unorganized.normals.clear();
    unorganized.colors.clear();
    EXPECT_NO_THROW(check(unorganized));
    EXPECT_FALSE(unorganized.organized());
}

TEST(PointCloud, CheckRejectsEveryBrokenInvariant) {
    PointCloud cloud = full_cloud();
    cloud.normals.pop_back();
    EXPECT_THROW(check(cloud), InvalidInput);
    cloud = full_cloud();
    cloud.colors.pop_back();
    EXPECT_THROW(check(cloud), InvalidInput);
    cloud = full_cloud();
    cloud.width = 4;
    EXPECT_THROW(check(cloud), InvalidInput);
    cloud = full_cloud();
    cloud.width = -3;
    cloud.height = -2;
    EXPECT_THROW(check(cloud), InvalidInput);
    cloud = full_cloud();
    cloud.points.clear();
    EXPECT_THROW(check(cloud), InvalidInput);
}

TEST(PointCloud, SelectKeepsOrderAndAttributes) {
    const PointCloud cloud = full_cloud();
    const std::vector<std::uint32_t> indices = {4, 0, 4};
    const PointCloud part = select(cloud, indices);
    ASSERT_EQ(part.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(part.points[i], cloud.points[indices[i]]);
        EXPECT_EQ(part.normals[i], cloud.normals[indices[i]]);
        EXPECT_EQ(part.colors[i], cloud.colors[indices[i]]);
    }
    EXPECT_FALSE(part.organized());
    EXPECT_EQ(part.viewpoint, cloud.viewpoint);
    EXPECT_TRUE(select(cloud, {}).empty());
}

TEST(PointCloud, RemoveInvalidKeepsTheFinite) {
    PointCloud cloud = full_cloud();
    cloud.points[1].y() = std::numeric_limits<float>::quiet_NaN();
    cloud.points[2].z() = std::numeric_limits<float>::infinity();
    cloud.normals[5] = test_clouds::nowhere();
    const PointCloud valid = remove_invalid(cloud);
    ASSERT_EQ(valid.size(), 3U);
    EXPECT_EQ(valid.colors[0][0], 0);
    EXPECT_EQ(valid.colors[1][0], 3);
    EXPECT_EQ(valid.colors[2][0], 4);
    EXPECT_NO_THROW(check(valid));
}

TEST(PointCloud, TransformedMovesPointsAndTurnsNormals) {
    Pose quarter = Pose::Identity();
    quarter.translate(Eigen::Vector3d(10, 0, 0));
    quarter.rotate(Eigen::AngleAxisd(kPi / 2.0, Eigen::Vector3d::UnitZ()));
    PointCloud cloud;
    cloud.points = {{1, 2, 3}};
    cloud.normals = {{1, 0, 0}};
    cloud.viewpoint = Vec3f(0, 0, 5);
    const PointCloud moved = transformed(cloud, quarter);
    EXPECT_LT((moved.points[0] - Vec3f(8, 1, 3)).norm(), 1e-6F);
    EXPECT_LT((moved.normals[0] - Vec3f(0, 1, 0)).norm(), 1e-6F);
    EXPECT_LT((moved.viewpoint - Vec3f(10, 0, 5)).norm(), 1e-6F);
}

TEST(PointCloud, TransformedAndInverseGiveTheCloudBack) {
    const PointCloud cloud = full_cloud();
    const Pose pose = test_clouds::random_pose(3);
    const PointCloud back = transformed(transformed(cloud, pose), pose.inverse());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        EXPECT_LT((back.points[i] - cloud.points[i]).norm(), 2e-6F);
        EXPECT_LT((back.normals[i] - cloud.normals[i]).norm(), 1e-6F);
    }
    EXPECT_LT((back.viewpoint - cloud.viewpoint).norm(), 2e-6F);
    EXPECT_EQ(back.colors, cloud.colors);
    EXPECT_EQ(back.width, cloud.width);
}

TEST(PointCloud, TransformedKeepsNoReturnsMarked) {
    PointCloud cloud;
    cloud.points = {test_clouds::nowhere()};
    EXPECT_TRUE(transformed(cloud, test_clouds::random_pose(1)).points[0].array().isNaN().all());
}

TEST(PointCloud, ScaledMultipliesLengthsOnly) {
    const PointCloud cloud = full_cloud();
    const PointCloud large = scaled(cloud, 1000.0);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        EXPECT_LT((large.points[i] - 1000.0F * cloud.points[i]).norm(), 1e-3F);
        EXPECT_EQ(large.normals[i], cloud.normals[i]);
    }
    EXPECT_LT((large.viewpoint - Vec3f(1000, 2000, 3000)).norm(), 1e-3F);
    EXPECT_EQ(scaled(cloud, 1.0).points[3], cloud.points[3]);
}

// In single precision the sum of a million coordinates of 1000 would be off by several units.
TEST(PointCloud, CentroidSumsInDoublePrecision) {
    std::vector<Vec3f> points(1'000'000, Vec3f(1000.1F, -1000.1F, 0.1F));
    const Vec3d center = centroid(points);
    EXPECT_NEAR(center.x(), double{1000.1F}, 1e-7);
    EXPECT_NEAR(center.y(), double{-1000.1F}, 1e-7);
    EXPECT_NEAR(center.z(), double{0.1F}, 1e-9);
    points = {{0, 0, 0}, {2, 4, 6}};
    EXPECT_EQ(centroid(points), Vec3d(1, 2, 3));
}

}  // namespace
}  // namespace ostraka
