// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/planes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kOnPlane = 1500;

// 1500 points within 0.05 of the plane z = 0 (first), then 1000 on a sphere above it; moved.
PointCloud table_with_ball(const Pose& pose, std::uint64_t seed = 1) {
    PointCloud cloud;
    cloud.points = test_clouds::in_box(kOnPlane, seed, {30.0, 30.0, 0.05});
    cloud.normals.assign(kOnPlane, Vec3f::UnitZ());
    const PointCloud ball = test_clouds::sphere(1000, 8.0);
    for (std::size_t i = 0; i < ball.size(); ++i) {
        cloud.points.push_back(ball.points[i] + Vec3f(0, 0, 9));
        cloud.normals.push_back(ball.normals[i]);
    }
    cloud.viewpoint = Vec3f(10, 20, 150);
    return transformed(cloud, pose);
}

TEST(FindPlane, FindsTheTableAmongOutliers) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Pose pose = test_clouds::random_pose(seed, 100.0);
        const PointCloud cloud = table_with_ball(pose, seed);
        const auto plane = find_plane(cloud, 1000, {.tolerance = 0.2, .seed = seed});
        ASSERT_TRUE(plane.has_value());
        const Vec3d normal = pose.linear().col(2);
        EXPECT_GT(plane->normal.dot(normal), std::cos(1e-3)) << "toward the viewpoint";
        EXPECT_NEAR(plane->normal.norm(), 1.0, 1e-6);
        EXPECT_NEAR(plane->offset, normal.dot(pose.translation()), 0.05);
        EXPECT_TRUE(std::is_sorted(plane->inliers.begin(), plane->inliers.end()));
        ASSERT_EQ(plane->inliers.size(), kOnPlane);
        EXPECT_EQ(plane->inliers.back(), kOnPlane - 1);
    }
}

TEST(FindPlane, NormalPointsToTheViewpointFromEitherSide) {
    PointCloud cloud = table_with_ball(Pose::Identity());
    cloud.viewpoint.z() = -50.0F;
    const auto plane = find_plane(cloud, 1000, {.tolerance = 0.2});
    ASSERT_TRUE(plane.has_value());
    EXPECT_LT(plane->normal.z(), -0.99);
}

TEST(FindPlane, LeavesOutPointsWhoseNormalsDisagree) {
    PointCloud cloud = table_with_ball(Pose::Identity());
    for (std::size_t i = 0; i < 300; ++i) cloud.normals[i] = Vec3f::UnitX();
    const auto plane = find_plane(cloud, 1000, {.tolerance = 0.2});
    ASSERT_TRUE(plane.has_value());
    EXPECT_EQ(plane->inliers.size(), kOnPlane - 300);
    EXPECT_EQ(plane->inliers.front(), 300U);
}

TEST(FindPlane, FindsNoneWhereThereIsNone) {
    EXPECT_FALSE(find_plane(test_clouds::sphere(2000, 10.0), 500, {.tolerance = 0.2}));
    EXPECT_FALSE(find_plane(table_with_ball(Pose::Identity()), kOnPlane + 500, {.tolerance = 0.2}));
    EXPECT_FALSE(find_plane({}, 0, {.tolerance = 0.2}));
    PointCloud line;
    for (int i = 0; i < 100; ++i) {
        line.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
        line.normals.emplace_back(0.0F, 0.0F, 1.0F);
    }
    EXPECT_FALSE(find_plane(line, 10, {.tolerance = 0.2})) << "a line lies on many planes";
}

TEST(FindPlane, SameSeedSamePlaneForAnyNumberOfThreads) {
    const PointCloud cloud = table_with_ball(test_clouds::random_pose(3));
    set_thread_count(1);
    const auto one = find_plane(cloud, 100, {.tolerance = 0.2, .seed = 9});
    set_thread_count(4);
    const auto four = find_plane(cloud, 100, {.tolerance = 0.2, .seed = 9});
    set_thread_count(0);
    ASSERT_TRUE(one && four);
    EXPECT_EQ(one->normal, four->normal);
    EXPECT_EQ(one->offset, four->offset);
    EXPECT_EQ(one->inliers, four->inliers);
}

TEST(FindPlane, RejectsMissingNormalsAndTrials) {
    PointCloud cloud = table_with_ball(Pose::Identity());
    EXPECT_THROW(find_plane(cloud, 10, {.tolerance = 0.2, .trials = 0}), InvalidInput);
    cloud.normals.clear();
    EXPECT_THROW(find_plane(cloud, 10, {.tolerance = 0.2}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
