// SPDX-License-Identifier: Apache-2.0
#include "ostraka/registration/icp.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cloud/test_clouds.hpp"
#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

constexpr double kSize = 100.0;  // of the shapes, about
const IcpSettings kSettings{.iterations = 40, .start_distance = 12.0, .end_distance = 2.0};

// A turn by `degrees` about a random axis through the origin, then a shift.
Pose disturbance(double degrees, double shift, std::uint64_t seed) {
    Random random(seed);
    Pose pose = Pose::Identity();
    pose.translate(Eigen::Vector3d(shift * random.direction()));
    pose.rotate(Eigen::AngleAxisd(degrees * kPi / 180.0, Eigen::Vector3d(random.direction())));
    return pose;
}

double angle_of(const Pose& pose) {
    return Eigen::AngleAxisd(Eigen::Matrix3d(pose.linear())).angle();
}

// How far the estimate puts points of the shape from where they belong, at most.
double misplacement(const PointCloud& source, const Pose& found, const Pose& truth) {
    double worst = 0.0;
    for (const Vec3f& point : source.points) {
        const Vec3d p = point.cast<double>();
        worst = std::max(worst, (found * p - truth * p).norm());
    }
    return worst;
}

// Source: other samples of the same surface, in a frame of their own.
TEST(Icp, RecoversKnownPoses) {
    for (const bool bumpy : {true, false}) {
        const PointCloud target =
            bumpy ? shapes::bumpy_ellipsoid(12'000, 11) : shapes::notched_box(12'000, 12);
        const PointCloud piece =
            bumpy ? shapes::bumpy_ellipsoid(1500, 21) : shapes::notched_box(1500, 22);
        const SurfaceField field(target, 1.0, 20.0);
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
            const Pose truth = test_clouds::random_pose(seed, 200.0);
            const PointCloud source = transformed(piece, truth.inverse());
            const Pose guess = disturbance(10.0, 0.03 * kSize, seed + 50) * truth;
            ASSERT_GT(misplacement(source, guess, truth), 3.0);
            const IcpResult result = icp(field, source.points, source.normals, guess, kSettings);
            EXPECT_TRUE(result.converged);
            EXPECT_GT(result.iterations, 1);
            EXPECT_LE(result.iterations, kSettings.iterations);
            EXPECT_GT(result.inliers, 1400);
            EXPECT_LE(result.inliers, 1500);
            EXPECT_LT(result.rms, 0.15);
            EXPECT_LT(misplacement(source, result.T_target_source, truth), 0.003 * kSize);
            EXPECT_LT(angle_of(result.T_target_source * truth.inverse()), 0.003);
        }
    }
}

TEST(Icp, StaysAtTheTruePose) {
    const PointCloud target = shapes::bumpy_ellipsoid(8000);
    const SurfaceField field(target, 1.0, 10.0);
    const IcpResult result = icp(field, target.points, target.normals, Pose::Identity(), kSettings);
    EXPECT_TRUE(result.converged);
    EXPECT_LT(misplacement(target, result.T_target_source, Pose::Identity()), 0.02);
}

TEST(Icp, ResultIsARigidMotion) {
    const PointCloud target = shapes::cut_torus(5000);
    const SurfaceField field(target, 1.0, 20.0);
    const IcpResult result =
        icp(field, target.points, target.normals, disturbance(8.0, 3.0, 2), kSettings);
    const Mat3d R = result.T_target_source.linear();
    EXPECT_LT((R * R.transpose() - Mat3d::Identity()).norm(), 1e-9);
    EXPECT_NEAR(R.determinant(), 1.0, 1e-9);
}

// Which frame both sets are given in must not matter.
TEST(Icp, TurnsWithBothSets) {
    const PointCloud target = shapes::bumpy_ellipsoid(8000, 3);
    const PointCloud source = shapes::bumpy_ellipsoid(1000, 4);
    const Pose guess = disturbance(6.0, 2.0, 5);
    const IcpResult plain =
        icp(SurfaceField(target, 1.0, 20.0), source.points, source.normals, guess, kSettings);
    const Pose pose = test_clouds::random_pose(6, 50.0);
    const IcpResult turned = icp(SurfaceField(transformed(target, pose), 1.0, 20.0), source.points,
                                 source.normals, pose * guess, kSettings);
    EXPECT_LT(misplacement(source, pose.inverse() * turned.T_target_source, plain.T_target_source),
              0.1);
}

TEST(Icp, IgnoresClutterBeyondTheEndDistance) {
    const PointCloud target = shapes::notched_box(12'000, 1);
    PointCloud source = shapes::notched_box(1500, 2);
    Random random(7);
    for (int i = 0; i < 600; ++i) {  // a neighboring object
        source.points.push_back(
            Vec3d(random.uniform(-60, 60), random.uniform(-60, 60), 60.0).cast<float>());
        source.normals.emplace_back(0.0F, 0.0F, 1.0F);
    }
    const SurfaceField field(target, 1.0, 20.0);
    const IcpResult result =
        icp(field, source.points, source.normals, disturbance(6.0, 2.0, 8), kSettings);
    EXPECT_LT(misplacement(source, result.T_target_source, Pose::Identity()), 0.5);
}

// A quarter of the points is displaced by 1.6, within the end distance of 2: plain least squares
// would shift by a quarter of that, the biweight by about a tenth of it.
TEST(Icp, OutliersWithinReachWeighLittle) {
    const PointCloud target = shapes::bumpy_ellipsoid(12'000, 1);
    PointCloud source = shapes::bumpy_ellipsoid(2000, 2);
    const PointCloud clean = source;
    for (std::size_t i = 0; i < source.size(); i += 4) {
        source.points[i] += 1.6F * source.normals[i];
    }
    const SurfaceField field(target, 1.0, 20.0);
    const IcpResult result =
        icp(field, source.points, source.normals, disturbance(3.0, 1.0, 3), kSettings);
    EXPECT_TRUE(result.converged);
    const Vec3d middle = centroid(clean.points);
    EXPECT_LT((result.T_target_source * middle - middle).norm(), 0.2);
}

TEST(Icp, APlaneConvergesAlthoughItSlides) {
    PointCloud target;
    target.points = test_clouds::lattice(80, 1.0F);
    target.normals.assign(target.size(), Vec3f::UnitZ());
    const SurfaceField field(target, 1.0, 10.0);
    const PointCloud part = [&] {
        PointCloud cloud;
        for (const Vec3f& p : target.points) {
            if ((p - Vec3f(40, 40, 0)).norm() > 20.0F) continue;
            cloud.points.push_back(p);
            cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
        }
        return cloud;
    }();
    Pose guess = Pose::Identity();
    guess.translate(Eigen::Vector3d(3.0, 0.0, 2.0));
    guess.rotate(Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitX()));
    const IcpResult result = icp(field, part.points, part.normals, guess, kSettings);
    EXPECT_TRUE(result.converged);
    EXPECT_LT(result.rms, 1e-2);
    for (const Vec3f& point : part.points) {
        const Vec3d at = result.T_target_source * point.cast<double>();
        ASSERT_NEAR(at.z(), 0.0, 0.02);
        ASSERT_LT((at - point.cast<double>()).norm(), 8.0) << "it doesn't drift away";
    }
}

TEST(Icp, GivesBackTheGuessWhereNothingIsNear) {
    const PointCloud target = shapes::bumpy_ellipsoid(2000);
    const SurfaceField field(target, 1.0, 20.0);
    Pose guess = Pose::Identity();
    guess.translate(Eigen::Vector3d(500.0, 0.0, 0.0));
    IcpResult result = icp(field, target.points, target.normals, guess, kSettings);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.inliers, 0);
    EXPECT_EQ(result.iterations, 0);
    EXPECT_TRUE(result.T_target_source.matrix() == guess.matrix());

    std::vector<Vec3f> reversed = target.normals;  // on the surface, but facing away
    for (Vec3f& normal : reversed) normal = -normal;
    result = icp(field, target.points, reversed, Pose::Identity(), kSettings);
    EXPECT_FALSE(result.converged);
    EXPECT_LT(result.inliers, 6);

    result = icp(field, {}, {}, guess, kSettings);
    EXPECT_FALSE(result.converged);
    EXPECT_TRUE(result.T_target_source.matrix() == guess.matrix());
}

TEST(Icp, RejectsMissingNormalsAndDistances) {
    const PointCloud target = shapes::bumpy_ellipsoid(500);
    const SurfaceField field(target, 2.0, 5.0);
    EXPECT_THROW(icp(field, target.points, {}, Pose::Identity(), kSettings), InvalidInput);
    EXPECT_THROW(icp(field, target.points, target.normals, Pose::Identity(), {}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
