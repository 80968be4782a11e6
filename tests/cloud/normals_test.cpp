// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/normals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

double angle_between(const Vec3f& a, const Vec3d& b) {
    return std::atan2(a.cast<double>().cross(b).norm(), a.cast<double>().dot(b));
}

TEST(Normals, OfAPlaneAreItsNormal) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Pose pose = test_clouds::random_pose(seed, 50.0);
        PointCloud cloud;
        for (const Vec3f& point : test_clouds::in_box(400, seed, {20.0, 20.0, 0.0})) {
            cloud.points.push_back((pose * point.cast<double>()).cast<float>());
        }
        cloud.viewpoint = (pose * Vec3d(3.0, 4.0, 80.0)).cast<float>();
        for (const Vec3f& normal : estimate_normals(cloud)) {
            ASSERT_NEAR(normal.norm(), 1.0F, 1e-6F);
            ASSERT_LT(angle_between(normal, pose.linear().col(2)), 1e-4);
        }
    }
}

TEST(Normals, TurnTowardTheViewpoint) {
    PointCloud cloud;
    cloud.points = test_clouds::lattice(12, 1.0F);
    cloud.viewpoint = Vec3f(5, 5, -30);
    for (const Vec3f& normal : estimate_normals(cloud)) {
        EXPECT_LT((normal - Vec3f(0, 0, -1)).norm(), 1e-5F);
    }
}

TEST(Normals, OfASphereAreRadial) {
    PointCloud cloud = test_clouds::sphere(20'000, 10.0);
    cloud.normals.clear();
    cloud.viewpoint = Vec3f::Zero();  // inside: normals point to the center
    double mean = 0.0;
    const std::vector<Vec3f> normals = estimate_normals(cloud);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const double angle = angle_between(normals[i], -cloud.points[i].cast<double>());
        ASSERT_LT(angle, 0.15);
        mean += angle / static_cast<double>(cloud.size());
    }
    EXPECT_LT(mean, 0.03);
}

TEST(Normals, MoreNeighborsAverageNoise) {
    PointCloud cloud;
    cloud.points = test_clouds::in_box(3000, 5, {10.0, 10.0, 0.05});
    cloud.viewpoint = Vec3f(0, 0, 100);
    const auto mean_error = [&](int neighbors) {
        double sum = 0.0;
        for (const Vec3f& normal : estimate_normals(cloud, {.neighbors = neighbors})) {
            sum += angle_between(normal, Vec3d::UnitZ());
        }
        return sum / static_cast<double>(cloud.size());
    };
    EXPECT_LT(mean_error(60), 0.5 * mean_error(10));
}

TEST(Normals, AreNoneOnALineOrWithTooFewPoints) {
    for (const Vec3f& step : {Vec3f(1, 0, 0), Vec3f(1, 2, 3), Vec3f(-0.3F, 0.7F, 0.1F)}) {
        PointCloud line;
        for (int i = 0; i < 40; ++i) line.points.push_back(Vec3f(static_cast<float>(i) * step));
        line.viewpoint = Vec3f(0, 0, 100);
        for (const Vec3f& normal : estimate_normals(line)) {
            ASSERT_TRUE(normal.array().isNaN().all()) << step.transpose();
        }
    }
    PointCloud pair;
    pair.points = {{0, 0, 0}, {1, 0, 0}};
    for (const Vec3f& normal : estimate_normals(pair)) EXPECT_TRUE(normal.array().isNaN().all());
    PointCloud same;
    same.points.assign(30, Vec3f(1, 2, 3));
    for (const Vec3f& normal : estimate_normals(same)) EXPECT_TRUE(normal.array().isNaN().all());
    EXPECT_TRUE(estimate_normals({}).empty());
}

TEST(Normals, TurnWithTheCloud) {
    PointCloud cloud = test_clouds::sphere(1500, 4.0);
    cloud.viewpoint = Vec3f(9, 9, 9);
    const Pose pose = test_clouds::random_pose(3);
    const std::vector<Vec3f> before = estimate_normals(cloud);
    const std::vector<Vec3f> after = estimate_normals(transformed(cloud, pose));
    std::size_t turned = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        // On the silhouette rounding decides the sign; ties decide the neighbors.
        if (angle_between(after[i], pose.linear() * before[i].cast<double>()) < 1e-3) ++turned;
    }
    EXPECT_GT(turned, cloud.size() * 99 / 100);
}

TEST(Normals, AreTheSameBytesForAnyNumberOfThreads) {
    const PointCloud cloud = test_clouds::sphere(4000, 1.0);
    set_thread_count(1);
    const std::vector<Vec3f> one = estimate_normals(cloud);
    set_thread_count(4);
    const std::vector<Vec3f> four = estimate_normals(cloud);
    set_thread_count(0);
    ASSERT_EQ(one.size(), four.size());
    EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof(Vec3f)), 0);
}

TEST(Normals, RejectFewerThanThreeNeighbors) {
    EXPECT_THROW(estimate_normals(test_clouds::sphere(10, 1.0), {.neighbors = 2}), InvalidInput);
}

TEST(NormalsWithin, AreThoseOfTheNeighborsInTheBall) {
    PointCloud cloud;
    cloud.points = test_clouds::in_box(1500, 8, {6.0, 6.0, 0.4}, {200.0, -90.0, 40.0});
    cloud.viewpoint = Vec3f(200, -90, 300);
    const std::vector<Vec3f> normals = estimate_normals_within(cloud, 1.1);
    for (std::size_t i = 0; i < cloud.size(); i += 7) {
        std::vector<std::uint32_t> ball;
        for (std::uint32_t j = 0; j < cloud.size(); ++j) {
            if ((cloud.points[j] - cloud.points[i]).norm() < 1.1F) ball.push_back(j);
        }
        // All of these and no more are the neighbors of the first of them.
        const PointCloud some = select(cloud, ball);
        const std::vector<Vec3f> expected = estimate_normals(
            some, {.neighbors = static_cast<int>(std::max<std::size_t>(3, some.size()))});
        ASSERT_NEAR(normals[i].norm(), 1.0F, 1e-5F);
        EXPECT_LT(angle_between(normals[i], expected.front().cast<double>()), 2e-3) << i;
    }
}

TEST(NormalsWithin, OfASphereAreRadialAndTurnTowardTheViewpoint) {
    PointCloud cloud = test_clouds::sphere(20'000, 10.0);
    cloud.viewpoint = Vec3f::Zero();
    const std::vector<Vec3f> normals = estimate_normals_within(cloud, 0.8);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        ASSERT_LT(angle_between(normals[i], -cloud.points[i].cast<double>()), 0.2);
    }
}

TEST(NormalsWithin, AreNoneOnALineOrWithTooFewPoints) {
    for (const Vec3f& start : {Vec3f(0, 0, 0), Vec3f(120, -330, 900)}) {
        for (const Vec3f& step : {Vec3f(1, 0, 0), Vec3f(1, 2, 3), Vec3f(-0.3F, 0.7F, 0.1F)}) {
            PointCloud line;
            for (int i = 0; i < 40; ++i) {
                line.points.push_back(Vec3f(start + static_cast<float>(i) * step));
            }
            line.viewpoint = Vec3f(0, 0, 5000);
            for (const Vec3f& normal : estimate_normals_within(line, 8.5 * double{step.norm()})) {
                EXPECT_TRUE(normal.array().isNaN().all())
                    << start.transpose() << ", " << step.transpose();
            }
        }
    }
    PointCloud apart;
    apart.points = {{0, 0, 0}, {1, 0, 0}, {0, 5, 0}, {5, 5, 0}};
    for (const Vec3f& normal : estimate_normals_within(apart, 2.0)) {
        EXPECT_TRUE(normal.array().isNaN().all());
    }
    PointCloud same;
    same.points.assign(30, Vec3f(1, 2, 3));
    for (const Vec3f& normal : estimate_normals_within(same, 1.0)) {
        EXPECT_TRUE(normal.array().isNaN().all());
    }
    EXPECT_TRUE(estimate_normals_within({}, 1.0).empty());
}

TEST(NormalsWithin, ANarrowStripStillHasOne) {
    PointCloud strip;
    for (int i = 0; i < 60; ++i) {
        strip.points.emplace_back(0.1F * static_cast<float>(i), i % 2 == 0 ? 0.0F : 0.03F, 0.0F);
    }
    strip.viewpoint = Vec3f(3, 0, 50);
    for (const Vec3f& normal : estimate_normals_within(strip, 1.0)) {
        EXPECT_LT(angle_between(normal, Vec3d::UnitZ()), 1e-3);
    }
}

TEST(NormalsWithin, AreTheSameBytesForAnyNumberOfThreads) {
    const PointCloud cloud = test_clouds::sphere(4000, 1.0);
    set_thread_count(1);
    const std::vector<Vec3f> one = estimate_normals_within(cloud, 0.15);
    set_thread_count(4);
    const std::vector<Vec3f> four = estimate_normals_within(cloud, 0.15);
    set_thread_count(0);
    ASSERT_EQ(one.size(), four.size());
    EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof(Vec3f)), 0);
}

}  // namespace
}  // namespace ostraka
