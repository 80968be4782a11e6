// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/surface_thickness.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

// A plane with normal noise along its normal, turned by `R`.
PointCloud noisy_plane(double deviation, const Mat3d& R) {
    Random random(5);
    PointCloud cloud;
    for (int i = 0; i < 40000; ++i) {
        const double x = 100.0 * random.uniform();
        const double y = 100.0 * random.uniform();
        cloud.points.push_back((R * Vec3d(x, y, deviation * random.normal())).cast<float>());
    }
    return cloud;
}

TEST(SurfaceThickness, OfAPlaneIsItsNoise) {
    EXPECT_NEAR(surface_thickness(noisy_plane(0.0, Mat3d::Identity()), 4.0), 0.0, 1e-4);
    const Mat3d turn = Random(3).rotation();
    for (const double deviation : {0.1, 0.5}) {
        const double found = surface_thickness(noisy_plane(deviation, Mat3d::Identity()), 4.0);
        EXPECT_NEAR(found, deviation, 0.05 * deviation);
        EXPECT_NEAR(surface_thickness(noisy_plane(deviation, turn), 4.0), found, 0.02 * deviation);
    }
}

// A million points in one place, which would each look at all others: this takes a blink, or
// minutes.
TEST(SurfaceThickness, OfManyPointsInOnePlaceIsTheirNoise) {
    Random random(2);
    PointCloud cloud;
    for (int i = 0; i < 1'000'000; ++i) {
        cloud.points.push_back(
            Vec3d(random.uniform(), random.uniform(), 0.05 * random.normal()).cast<float>());
    }
    EXPECT_NEAR(surface_thickness(cloud, 4.0), 0.05, 0.005);
}

// Points that fill a ball of radius r have a variance of r^2 / 5 in each direction.
TEST(SurfaceThickness, OfWhatFillsSpaceIsTheBalls) {
    Random random(9);
    PointCloud cloud;
    for (int i = 0; i < 60000; ++i) {
        cloud.points.push_back(
            (30.0 * Vec3d(random.uniform(), random.uniform(), random.uniform())).cast<float>());
    }
    const double limit = 3.0 / std::sqrt(5.0);
    const double found = surface_thickness(cloud, 3.0);
    EXPECT_LT(found, limit);
    EXPECT_GT(found, 0.9 * limit);
}

TEST(SurfaceThickness, NeedsPlanes) {
    PointCloud line;
    for (int i = 0; i < 100; ++i) line.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    EXPECT_EQ(surface_thickness(line, 5.0), 0.0);
    EXPECT_EQ(surface_thickness({}, 5.0), 0.0);
}

}  // namespace
}  // namespace ostraka
