// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/pose_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mesh/test_meshes.hpp"
#include "ostraka/base/random.hpp"
#include "ostraka/mesh/symmetry_poses.hpp"

namespace ostraka {
namespace {

// Straight from the definition, in the scene's frame.
double adi_by_definition(const std::vector<Vec3f>& points, const Pose& truth,
                         const Pose& estimate) {
    double sum = 0.0;
    for (const Vec3f& a : points) {
        double best = 1e300;
        for (const Vec3f& b : points) {
            best = std::min(best, (truth * a.cast<double>() - estimate * b.cast<double>()).norm());
        }
        sum += best;
    }
    return sum / static_cast<double>(points.size());
}

Pose random_pose(Random& random) {
    Pose pose = Pose::Identity();
    pose.linear() = random.rotation();
    pose.translation() = 5.0 * random.direction();
    return pose;
}

TEST(Adi, AgreesWithItsDefinitionOnRandomPoses) {
    Random random(1);
    std::vector<Vec3f> points;
    for (int i = 0; i < 60; ++i) points.push_back(Vec3d(10.0 * random.direction()).cast<float>());
    for (int i = 0; i < 100; ++i) {
        const Pose truth = random_pose(random);
        const Pose estimate = random_pose(random);
        EXPECT_NEAR(adi_error(points, truth, estimate), adi_by_definition(points, truth, estimate),
                    1e-4);
    }
}

TEST(Adi, ForgivesSymmetry) {
    const std::vector<Vec3f> square = {Vec3f(1, 1, 0), Vec3f(-1, 1, 0), Vec3f(-1, -1, 0),
                                       Vec3f(1, -1, 0)};
    Pose quarter = Pose::Identity();
    quarter.rotate(Eigen::AngleAxisd(kPi / 2.0, Eigen::Vector3d::UnitZ()));
    EXPECT_NEAR(adi_error(square, Pose::Identity(), quarter), 0.0, 1e-6);
    Pose aside = Pose::Identity();
    aside.translation() = Vec3d(0.0, 0.0, 0.25);
    EXPECT_NEAR(adi_error(square, Pose::Identity(), aside), 0.25, 1e-6);
}

TEST(Adi, NoPointsGiveZero) {
    EXPECT_EQ(adi_error({}, Pose::Identity(), Pose::Identity()), 0.0);
}

Pose shifted(double x, double y, double z) {
    Pose pose = Pose::Identity();
    pose.translation() = Vec3d(x, y, z);
    return pose;
}

Pose turned(double angle, const Vec3d& axis) {
    Pose pose = Pose::Identity();
    pose.rotate(Eigen::AngleAxisd(angle, axis));
    return pose;
}

const std::vector<Pose> kNoSymmetry = {Pose::Identity()};

// The half turns of a box.
std::vector<Pose> box_symmetries() {
    return {Pose::Identity(), turned(kPi, Vec3d::UnitX()), turned(kPi, Vec3d::UnitY()),
            turned(kPi, Vec3d::UnitZ())};
}

TEST(Mssd, OfAPureShiftIsItsLength) {
    Random random(3);
    const TriangleMesh mesh = test_meshes::random_triangles(20, 4);
    for (int i = 0; i < 50; ++i) {
        const Pose truth = random_pose(random);
        const Vec3d shift = random.uniform(0.0, 3.0) * random.direction();
        Pose estimate = truth;
        estimate.translation() += shift;
        EXPECT_NEAR(mssd_error(mesh.vertices, kNoSymmetry, truth, estimate), shift.norm(), 1e-12);
    }
    EXPECT_EQ(mssd_error({}, kNoSymmetry, Pose::Identity(), shifted(1, 0, 0)), 0.0);
}

TEST(Mssd, OfATurnIsTheChordOfTheFarthestPoint) {
    const TriangleMesh box = test_meshes::box({3.0F, 4.0F, 1.0F});  // corners 5 from the z axis
    Random random(5);
    const Pose truth = random_pose(random);
    const double angle = 0.4;
    const Pose estimate = truth * turned(angle, Vec3d::UnitZ());
    EXPECT_NEAR(mssd_error(box.vertices, kNoSymmetry, truth, estimate),
                2.0 * 5.0 * std::sin(angle / 2.0), 1e-12);
}

TEST(Mssd, ForgivesABoxItsHalfTurnsOnly) {
    const TriangleMesh box = test_meshes::box({1.0F, 2.0F, 3.0F});
    Random random(6);
    const Pose truth = random_pose(random);
    for (const Pose& symmetry : box_symmetries()) {
        EXPECT_NEAR(mssd_error(box.vertices, box_symmetries(), truth, truth * symmetry), 0.0,
                    1e-12);
    }
    // Without them, a half turn moves a corner by twice its distance from the axis.
    EXPECT_NEAR(mssd_error(box.vertices, kNoSymmetry, truth, truth * turned(kPi, Vec3d::UnitX())),
                2.0 * std::hypot(2.0, 3.0), 1e-12);
    // A quarter turn about z is none of them: the best of 90 and -90 degrees moves every corner
    // along the chord of a quarter circle.
    EXPECT_NEAR(mssd_error(box.vertices, box_symmetries(), truth,
                           truth * turned(kPi / 2.0, Vec3d::UnitZ())),
                std::sqrt(2.0) * std::hypot(1.0, 2.0), 1e-12);
    // The symmetry turns the model, not the scene.
    EXPECT_NEAR(mssd_error(box.vertices, box_symmetries(), truth,
                           shifted(0.0, 0.5, 0.0) * truth * turned(kPi, Vec3d::UnitY())),
                0.5, 1e-12);
}

TEST(Mssd, OfAContinuousAxisForgivesAnyTurnToHalfAStep) {
    Symmetry symmetry;
    symmetry.axes = {{Vec3d::UnitZ(), Vec3d(7.0, 0.0, 0.0)}};
    const int steps = 315;
    const std::vector<Pose> motions = symmetry_motions(symmetry, steps);
    std::vector<Vec3f> ring;  // radius 2 around the axis
    for (int i = 0; i < 40; ++i) {
        ring.emplace_back(7.0F + 2.0F * std::cos(0.157F * static_cast<float>(i)),
                          2.0F * std::sin(0.157F * static_cast<float>(i)), 0.0F);
    }
    const double half_step = 2.0 * 2.0 * std::sin(kPi / steps / 2.0);
    Random random(7);
    double greatest = 0.0;
    for (int i = 0; i < 100; ++i) {
        const Pose truth = random_pose(random);
        const Pose turn = shifted(7, 0, 0) * turned(random.uniform(0.0, 6.28), Vec3d::UnitZ()) *
                          shifted(-7, 0, 0);
        const double error = mssd_error(ring, motions, truth, truth * turn);
        EXPECT_LE(error, half_step * 1.0001);
        greatest = std::max(greatest, error);
    }
    EXPECT_GT(greatest, 0.8 * half_step);
    // About another line, parallel to it, the ring's center moves along a chord.
    EXPECT_NEAR(mssd_error(ring, motions, Pose::Identity(), turned(kPi, Vec3d::UnitZ())), 14.0,
                2.0 * half_step);
}

TEST(Mspd, OfAShiftParallelToTheImageIsFocalLengthTimesShiftByDepth) {
    const PinholeCamera camera{640, 480, 500.0, 600.0, 319.5, 239.5};
    // A flat model, all of it at one depth.
    const std::vector<Vec3f> points = {Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(0, 2, 0)};
    const Pose truth = shifted(3.0, -2.0, 50.0);
    const auto error = [&](double x, double y) {
        return mspd_error(points, kNoSymmetry, truth, shifted(x, y, 0.0) * truth, camera);
    };
    EXPECT_NEAR(error(0.7, 0.0), 500.0 * 0.7 / 50.0, 1e-9);
    EXPECT_NEAR(error(0.0, 0.7), 600.0 * 0.7 / 50.0, 1e-9);
    EXPECT_NEAR(error(0.3, 0.4), std::hypot(500.0 * 0.3, 600.0 * 0.4) / 50.0, 1e-9);
    // Along the line of sight of a point, that point stays where it is.
    const std::vector<Vec3f> middle = {Vec3f::Zero()};
    Pose closer = truth;
    closer.translation() *= 0.5;
    EXPECT_NEAR(mspd_error(middle, kNoSymmetry, truth, closer, camera), 0.0, 1e-9);
}

TEST(Mspd, ForgivesSymmetryAndKnowsWhatIsBehindTheCamera) {
    const PinholeCamera camera;
    const TriangleMesh box = test_meshes::box({1.0F, 2.0F, 3.0F});
    const Pose truth = shifted(1.0, 2.0, 60.0) * turned(0.5, Vec3d(1, 1, 1).normalized());
    const Pose half = truth * turned(kPi, Vec3d::UnitZ());
    EXPECT_NEAR(mspd_error(box.vertices, box_symmetries(), truth, half, camera), 0.0, 1e-9);
    EXPECT_GT(mspd_error(box.vertices, kNoSymmetry, truth, half, camera), 10.0);
    EXPECT_TRUE(
        std::isinf(mspd_error(box.vertices, box_symmetries(), truth, shifted(0, 0, 2.0), camera)));
    EXPECT_EQ(mspd_error({}, kNoSymmetry, truth, half, camera), 0.0);
}

// A plate that fills part of a small image at z = 100.
class Vsd : public ::testing::Test {
  protected:
    static constexpr double kDiameter = 100.0;
    std::vector<double> at(double x, double z) const {
        return distance_image(plate_, camera_, shifted(x, 0.0, z));
    }
    std::vector<double> errors(const std::vector<double>& scan, const std::vector<double>& truth,
                               const std::vector<double>& estimate) const {
        return vsd_errors(scan, truth, estimate, kDiameter);
    }

    PinholeCamera camera_{40, 30, 40.0, 40.0, 19.5, 14.5};
    RayModel plate_{test_meshes::box({20.0F, 20.0F, 0.001F})};
};

TEST_F(Vsd, DistanceImagesHoldDistancesFromTheCenter) {
    const std::vector<double> image = at(0.0, 100.001);
    ASSERT_EQ(image.size(), 1200U);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        const Vec3d ray = camera_.ray(static_cast<double>(i % 40), static_cast<double>(i / 40));
        // The plate ends at 20 / 100 of the focal length: 8 pixels from the middle.
        const bool inside = std::max(std::abs(ray.x()), std::abs(ray.y())) < 0.2;
        seen += inside ? 1 : 0;
        ASSERT_NEAR(image[i], inside ? 100.0 * ray.norm() : 0.0, 1e-5);
    }
    EXPECT_EQ(seen, 256U);
}

TEST_F(Vsd, OfTheSamePoseIsZeroAndOfOneFarAwayIsOne) {
    const std::vector<double> truth = at(0.0, 100.0);
    for (const double error : errors(truth, truth, truth)) EXPECT_EQ(error, 0.0);
    // Beside the object: each pixel is of one of them only. The scan shows nothing there.
    for (const double error : errors(truth, truth, at(45.0, 100.0))) EXPECT_EQ(error, 1.0);
    // Nothing to be seen of either: nothing was right.
    const std::vector<double> none(truth.size(), 0.0);
    for (const double error : errors(none, none, none)) EXPECT_EQ(error, 1.0);
}

TEST_F(Vsd, CountsTheShareOfTheUnion) {
    // Half a plate aside: an overlap of 8 columns, and 8 more of each.
    const std::vector<double> truth = at(0.0, 100.0);
    for (const double error : errors(truth, truth, at(20.0, 100.0))) {
        EXPECT_NEAR(error, 2.0 / 3.0, 1e-12);
    }
}

TEST_F(Vsd, IgnoresPixelsThatTheScanHides) {
    const std::vector<double> truth = at(0.0, 100.0);
    const std::vector<double> aside = at(20.0, 100.0);
    // A wall 20 in front (more than delta) of the right half of the image hides all that is there:
    // 8 columns of the truth and all of the other are gone.
    std::vector<double> scan(truth.size(), 200.0);
    for (std::size_t i = 0; i < scan.size(); ++i) scan[i] = i % 40 < 20 ? truth[i] : 60.0;
    for (const double error : errors(scan, truth, truth)) EXPECT_EQ(error, 0.0);
    // Of the one aside nothing is to be seen; 8 columns of the truth are, all of them wrong.
    for (const double error : errors(scan, truth, aside)) EXPECT_EQ(error, 1.0);
    // Deeper, the plate is smaller: 7 x 14 of the 8 x 16 pixels that can be seen. The others are of
    // the truth only; the hidden half counts for nothing.
    const std::vector<double> deeper = errors(scan, truth, at(0.0, 112.0));
    EXPECT_EQ(deeper.front(), 1.0);
    EXPECT_NEAR(deeper.back(), 1.0 - 98.0 / 128.0, 1e-12);
    // A wall within delta hides nothing.
    for (double& value : scan) value = 100.0;
    for (const double error : errors(scan, truth, aside)) EXPECT_NEAR(error, 2.0 / 3.0, 1e-12);
}

TEST_F(Vsd, WhatTheTruthShowsTheEstimateMayCover) {
    // The scan shows the truth; an estimate 30 behind it is hidden by it (30 > delta), but counts
    // where the truth is visible: there it is wrong by its distance, not missing.
    const std::vector<double> truth = at(0.0, 100.0);
    const std::vector<double> behind = at(0.0, 130.0);
    const std::vector<double> result = errors(truth, truth, behind);
    // The plate behind is smaller in the image: 40 * 20 / 130 = 6.15, so 12 x 12 of 16 x 16 pixels.
    EXPECT_EQ(result.front(), 1.0);
    EXPECT_NEAR(result.back(), 1.0 - 144.0 / 256.0, 1e-12);
}

TEST_F(Vsd, IsGradedByItsTolerances) {
    // 22 farther along the axis, a bit more along the slanted rays: tau 0.05 to 0.2 fail.
    const std::vector<double> truth = at(0.0, 100.0);
    std::vector<double> estimate = truth;
    for (double& value : estimate) value += value > 0.0 ? 22.0 : 0.0;
    const std::vector<double> result = errors(truth, truth, estimate);
    ASSERT_EQ(result.size(), 10U);
    for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(result[i], i < 4 ? 1.0 : 0.0) << i;
    // A difference of exactly tau is too much.
    EXPECT_EQ(vsd_errors(std::vector{100.0}, std::vector{100.0}, std::vector{125.0}, 100.0,
                         {.tolerances = {0.25, 0.26}}),
              (std::vector<double>{1.0, 0.0}));
}

}  // namespace
}  // namespace ostraka
