// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/range_smoothing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

constexpr double kSpacing = 2.0;
constexpr int kSide = 160;           // pixels
constexpr double kFocal = 800.0;     // pixels
constexpr double kDistance = 500.0;  // about 0.6 between neighboring points

using Surface = std::function<double(double, double)>;  // depth where a ray (u, v, 1) meets it

double slanted(double u, double v) {
    return kDistance / (1.0 - 0.6 * u + 0.3 * v);
}

double sphere(double u, double v) {
    // Radius 100 around (0, 0, kDistance + 100).
    const double c = kDistance + 100.0;
    const double a = u * u + v * v + 1.0;
    return (c - std::sqrt(c * c - a * (c * c - 1e4))) / a;
}

PointCloud seen(const Surface& depth, double noise, std::uint64_t seed = 1) {
    PointCloud cloud;
    Random random(seed);
    for (int row = 0; row < kSide; ++row) {
        for (int column = 0; column < kSide; ++column) {
            const double u = (column - kSide / 2) / kFocal;
            const double v = (row - kSide / 2) / kFocal;
            const double z = depth(u, v) + noise * random.normal();
            cloud.points.push_back(Vec3d(u * z, v * z, z).cast<float>());
        }
    }
    return cloud;
}

// Root mean square difference of depth along the rays.
double error(const PointCloud& cloud, const Surface& depth) {
    double sum = 0.0;
    for (const Vec3f& p : cloud.points) {
        const double z = double{p.z()};
        sum += std::pow(z - depth(double{p.x()} / z, double{p.y()} / z), 2);
    }
    return std::sqrt(sum / static_cast<double>(cloud.size()));
}

TEST(MeasureRangeNoise, FindsDeviationAndPitch) {
    for (const double noise : {0.3, 1.0, 4.0}) {
        for (const Surface& surface : {Surface(slanted), Surface(sphere)}) {
            const RangeNoise measured = measure_range_noise(seen(surface, noise), kSpacing);
            EXPECT_NEAR(measured.deviation, noise, 0.1 * noise);
            EXPECT_NEAR(measured.pitch, kDistance / kFocal, 0.1);
        }
    }
    EXPECT_LT(measure_range_noise(seen(sphere, 0.0), kSpacing).deviation, 0.01);
}

TEST(SmoothRanges, LeavesTheTargetedNoise) {
    for (const Surface& surface : {Surface(slanted), Surface(sphere)}) {
        const PointCloud noisy = seen(surface, 1.0);
        const PointCloud smooth = smooth_ranges(noisy, {.spacing = kSpacing});
        EXPECT_NEAR(error(noisy, surface), 1.0, 0.02);
        EXPECT_LT(error(smooth, surface), 0.3);
        ASSERT_EQ(smooth.size(), noisy.size());
        for (std::size_t i = 0; i < noisy.size(); i += 97) {
            EXPECT_LT(smooth.points[i].cross(noisy.points[i]).norm() / 500.0F, 1e-3F)
                << "a point left its line of sight";
        }
    }
}

TEST(RemainingDeviation, IsAboutWhatSmoothingLeaves) {
    for (const double noise : {0.3, 1.0, 3.0, 6.0}) {
        for (const double target : {0.06, 0.12, 0.3}) {
            const RangeSmoothingSettings settings{.spacing = kSpacing, .target = target};
            const PointCloud noisy = seen(slanted, noise);
            const double left = remaining_deviation(measure_range_noise(noisy, kSpacing), settings);
            const double found = error(smooth_ranges(noisy, settings), slanted);
            EXPECT_GT(left, 0.5 * found) << noise << " " << target;
            EXPECT_LT(left, 1.6 * found) << noise << " " << target;
        }
    }
    EXPECT_EQ(remaining_deviation({}, {.spacing = kSpacing}), 0.0);
    EXPECT_EQ(remaining_deviation({.deviation = 0.1, .pitch = 5.0}, {.spacing = kSpacing}), 0.1);
}

TEST(SmoothRanges, NoiseOfThreeSpacingsShrinksToATenth) {
    const PointCloud noisy = seen(slanted, 6.0);
    EXPECT_LT(error(smooth_ranges(noisy, {.spacing = kSpacing}), slanted), 0.8);
}

TEST(SmoothRanges, ADepthEdgeStaysSharp) {
    const Surface step = [](double u, double) { return u < 0.0 ? 500.0 : 540.0; };
    const PointCloud smooth = smooth_ranges(seen(step, 1.0), {.spacing = kSpacing});
    std::size_t between = 0;
    for (const Vec3f& p : smooth.points) between += p.z() > 505.0F && p.z() < 535.0F ? 1 : 0;
    EXPECT_EQ(between, 0U);
    EXPECT_LT(error(smooth, step), 0.4);
}

TEST(SmoothRanges, CurvedSurfaceStaysInPlace) {
    // A cylinder of radius 25: planes in windows of radius 6 lie 6^2 / (8 * 25) = 0.18 behind it.
    const Surface cylinder = [](double u, double) {
        const double c = kDistance + 25.0;
        const double a = u * u + 1.0;
        const double root = c * c - a * (c * c - 625.0);
        return root > 0.0 ? (c - std::sqrt(root)) / a : kDistance + 100.0;
    };
    const PointCloud smooth =
        smooth_ranges(seen(cylinder, 2.0), {.spacing = kSpacing, .max_radius = 3.0});
    double sum = 0.0;
    double count = 0.0;
    for (const Vec3f& p : smooth.points) {
        const double u = double{p.x()} / double{p.z()};
        if (std::abs(u) > 0.01) continue;  // the foremost 5 to each side
        sum += double{p.z()} - cylinder(u, 0.0);
        count += 1.0;
    }
    EXPECT_GT(count, 1000.0);
    EXPECT_NEAR(sum / count, 0.0, 0.07);
}

TEST(SmoothRanges, ExactDepthsComeBackUntouched) {
    const PointCloud exact = seen(sphere, 0.0);
    const PointCloud smooth = smooth_ranges(exact, {.spacing = kSpacing});
    for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_EQ(smooth.points[i], exact.points[i]);
}

TEST(SmoothRanges, MovesWithTheScan) {
    const PointCloud noisy = seen(sphere, 1.0);
    Pose T = Pose::Identity();
    T.linear() = Random(7).rotation();
    T.translation() = Vec3d(300.0, -200.0, 100.0);
    const PointCloud a = transformed(smooth_ranges(noisy, {.spacing = kSpacing}), T);
    const PointCloud b = smooth_ranges(transformed(noisy, T), {.spacing = kSpacing});
    // The image is another one after a turn, so other points share a window: noise, not bias.
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        sum += static_cast<double>((a.points[i] - b.points[i]).squaredNorm());
    }
    EXPECT_LT(std::sqrt(sum / static_cast<double>(a.size())), 0.25);
}

TEST(SmoothRanges, AnyNumberOfThreadsGivesTheSameBits) {
    const PointCloud noisy = seen(sphere, 1.0);
    set_thread_count(1);
    const PointCloud one = smooth_ranges(noisy, {.spacing = kSpacing});
    set_thread_count(4);
    const PointCloud four = smooth_ranges(noisy, {.spacing = kSpacing});
    set_thread_count(0);
    EXPECT_TRUE(one.points == four.points);
}

TEST(SmoothRanges, InvalidFewAndDegeneratePointsAreLeftAlone) {
    PointCloud cloud = seen(slanted, 1.0);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t i = 0; i < cloud.size(); i += 5) cloud.points[i] = Vec3f::Constant(nan);
    const PointCloud smooth = smooth_ranges(cloud, {.spacing = kSpacing});
    ASSERT_EQ(smooth.size(), cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        EXPECT_EQ(smooth.points[i].allFinite(), cloud.points[i].allFinite());
    }
    for (const std::size_t count : {0, 1, 50, 200}) {
        PointCloud same;
        same.points.assign(count, Vec3f(1.0F, 2.0F, 300.0F));
        EXPECT_TRUE(smooth_ranges(same, {.spacing = kSpacing}).points == same.points);
        PointCloud line;
        for (std::size_t i = 0; i < count; ++i) {
            line.points.emplace_back(static_cast<float>(i), 0.0F, 500.0F);
        }
        EXPECT_TRUE(smooth_ranges(line, {.spacing = kSpacing}).points == line.points);
    }
    PointCloud around;  // the viewpoint amid the points, as in a merged model
    Random random(3);
    for (int i = 0; i < 2000; ++i)
        around.points.push_back((50.0 * random.direction()).cast<float>());
    for (const Vec3f& p : smooth_ranges(around, {.spacing = kSpacing}).points) {
        EXPECT_TRUE(p.allFinite());
    }
    EXPECT_THROW(smooth_ranges(cloud, {.spacing = 0.0}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
