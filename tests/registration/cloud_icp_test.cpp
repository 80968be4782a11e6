// SPDX-License-Identifier: Apache-2.0
#include "ostraka/registration/cloud_icp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "cloud/test_clouds.hpp"
#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

// A turn by `degrees` about a random axis through `center`, then a shift.
Pose disturbance(double degrees, double shift, const Vec3d& center, std::uint64_t seed) {
    Random random(seed);
    Pose pose = Pose::Identity();
    pose.translate(Eigen::Vector3d(center + shift * random.direction()));
    pose.rotate(Eigen::AngleAxisd(degrees * kPi / 180.0, Eigen::Vector3d(random.direction())));
    pose.translate(Eigen::Vector3d(-center));
    return pose;
}

double radius_of(const PointCloud& cloud) {
    const Vec3d center = centroid(cloud.points);
    double radius = 0.0;
    for (const Vec3f& p : cloud.points) {
        radius = std::max(radius, (p.cast<double>() - center).norm());
    }
    return radius;
}

// How far the estimate puts points of the source from where they belong, at most.
double misplacement(const PointCloud& source, const Pose& found, const Pose& truth) {
    double worst = 0.0;
    for (const Vec3f& point : source.points) {
        const Vec3d p = point.cast<double>();
        worst = std::max(worst, (found * p - truth * p).norm());
    }
    return worst;
}

PointCloud without_normals(PointCloud cloud) {
    cloud.normals.clear();
    return cloud;
}

TEST(CloudIcp, OfIdenticalCloudsIsExact) {
    for (PointCloud& shape : shapes::all(6'000)) {
        const PointCloud cloud = without_normals(std::move(shape));
        const double radius = radius_of(cloud);
        for (std::uint64_t seed = 0; seed < 10; ++seed) {
            const Pose guess = disturbance(5.0, 0.036 * radius, centroid(cloud.points), seed);
            const IcpResult result = align_clouds(cloud, cloud, guess);
            EXPECT_TRUE(result.converged);
            EXPECT_EQ(result.inliers, 6'000);
            EXPECT_LT(result.iterations, 40);
            EXPECT_LT(misplacement(cloud, result.T_target_source, Pose::Identity()), 1e-9 * radius);
            EXPECT_LT(result.rms, 1e-6 * radius);
        }
    }
}

// The source: other samples of the same surface, in a frame of their own.
TEST(CloudIcp, RecoversKnownMotionsBetweenDifferentSamples) {
    const PointCloud target = without_normals(shapes::bumpy_ellipsoid(8'000, 11));
    const PointCloud piece = without_normals(shapes::bumpy_ellipsoid(5'000, 21));
    const double radius = radius_of(piece);
    const IcpTarget prepared(target);
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Pose truth = test_clouds::random_pose(seed, 200.0);
        const PointCloud source = transformed(piece, truth.inverse());
        const Pose guess =
            disturbance(10.0, 0.05 * radius, centroid(target.points), seed + 50) * truth;
        ASSERT_GT(misplacement(source, guess, truth), 0.05 * radius);
        const IcpResult result = align_clouds(prepared, source.points, guess);
        EXPECT_LT(misplacement(source, result.T_target_source, truth), 0.01 * radius) << seed;
        EXPECT_LT(result.rms, 0.005 * radius);
    }
}

// The target has lost a third; what has no counterpart must not pull.
TEST(CloudIcp, IgnoresWhatIsFarFromTheTarget) {
    const PointCloud source = without_normals(shapes::bumpy_ellipsoid(6'000));
    PointCloud target;
    target.viewpoint = source.viewpoint;
    for (const Vec3f& p : source.points) {
        if (p.x() < 15.0F) target.points.push_back(p);
    }
    ASSERT_LT(target.size(), 5'000U);
    const Pose guess = disturbance(3.0, 1.5, centroid(source.points), 3);
    const IcpResult result = align_clouds(target, source, guess, {.max_distance = 4.0});
    EXPECT_LT(result.inliers, 5'500);
    EXPECT_LT(misplacement(source, result.T_target_source, Pose::Identity()), 0.5);
}

TEST(CloudIcp, UsesTheNormalsOfTheTarget) {
    PointCloud target = shapes::bumpy_ellipsoid(3'000);
    const Pose guess = disturbance(4.0, 1.0, Vec3d::Zero(), 4);
    const IcpResult exact = align_clouds(target, target, guess);
    EXPECT_LT(misplacement(target, exact.T_target_source, Pose::Identity()), 1e-7);
    // Without any usable normal there is no pair.
    target.normals.assign(target.size(), test_clouds::nowhere());
    const IcpResult none = align_clouds(target, target, guess);
    EXPECT_FALSE(none.converged);
    EXPECT_TRUE(none.T_target_source.isApprox(guess, 0.0));
}

// Along a plane nothing holds the source: it must stay where it was guessed, but reach the plane.
TEST(CloudIcp, LeavesFreeDirectionsAlone) {
    PointCloud plane;
    for (const Vec3f& p : test_clouds::lattice(50, 1.0F)) plane.points.push_back(p);
    plane.viewpoint = Vec3f(0, 0, 100);
    PointCloud source = plane;
    source.points.clear();
    for (const Vec3f& p : plane.points) {
        if ((p - Vec3f(25, 25, 0)).norm() < 15.0F) source.points.push_back(p);
    }
    Pose guess = Pose::Identity();
    guess.translate(Eigen::Vector3d(0.3, -0.2, 1.5));
    const IcpResult result = align_clouds(plane, source, guess);
    EXPECT_TRUE(result.converged);
    Pose expected = Pose::Identity();
    expected.translate(Eigen::Vector3d(0.3, -0.2, 0.0));
    EXPECT_LT(misplacement(source, result.T_target_source, expected), 1e-6);
}

TEST(CloudIcp, TakesDegenerateInput) {
    const PointCloud cloud = without_normals(shapes::notched_box(500));
    EXPECT_THROW(align_clouds(PointCloud{}, cloud, Pose::Identity()), InvalidInput);
    EXPECT_THROW(align_clouds(cloud, cloud, Pose::Identity(), {.iterations = 0}), InvalidInput);
    EXPECT_THROW(align_clouds(cloud, cloud, Pose::Identity(), {.neighbors = 2}), InvalidInput);
    EXPECT_THROW(align_clouds(cloud, cloud, Pose::Identity(), {.max_distance = -1.0}),
                 InvalidInput);
    const Pose guess = test_clouds::random_pose(5);
    const auto stays = [&](const PointCloud& target, const PointCloud& source,
                           const CloudIcpSettings& settings) {
        const IcpResult result = align_clouds(target, source, guess, settings);
        EXPECT_FALSE(result.converged);
        EXPECT_TRUE(result.T_target_source.isApprox(guess, 0.0));
    };
    stays(cloud, {}, {});
    PointCloud line;
    for (int i = 0; i < 100; ++i) line.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    stays(line, cloud, {});
    PointCloud far = cloud;
    for (Vec3f& p : far.points) p += Vec3f(1e5F, 0, 0);
    stays(cloud, far, {.max_distance = 10.0});
    PointCloud few;
    few.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    stays(cloud, few, {});
    PointCloud same;
    same.points.assign(50, Vec3f(1, 2, 3));
    EXPECT_TRUE(align_clouds(cloud, same, guess).T_target_source.matrix().allFinite());
    EXPECT_TRUE(align_clouds(same, cloud, guess).T_target_source.matrix().allFinite());
}

TEST(CloudIcp, GivesTheSameBitsForAnyNumberOfThreads) {
    const PointCloud target = without_normals(shapes::bumpy_ellipsoid(5'000, 1));
    const PointCloud source = without_normals(shapes::bumpy_ellipsoid(5'000, 2));
    const Pose guess = disturbance(5.0, 2.0, Vec3d::Zero(), 6);
    set_thread_count(1);
    const IcpResult one = align_clouds(target, source, guess);
    set_thread_count(4);
    const IcpResult four = align_clouds(target, source, guess);
    set_thread_count(0);
    EXPECT_EQ(one.iterations, four.iterations);
    EXPECT_EQ(
        std::memcmp(one.T_target_source.data(), four.T_target_source.data(), 16 * sizeof(double)),
        0);
}

}  // namespace
}  // namespace ostraka
