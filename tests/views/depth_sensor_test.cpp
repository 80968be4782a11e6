// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/depth_sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace ostraka {
namespace {

constexpr std::uint64_t kPixels = 100'000;

// Mean and deviation of what many pixels report for one depth.
std::pair<double, double> statistics(double depth, const SensorSettings& settings) {
    double sum = 0.0;
    double squares = 0.0;
    for (std::uint64_t pixel = 0; pixel < kPixels; ++pixel) {
        const double error = measured_depth(depth, 1.0, pixel, settings) - depth;
        sum += error;
        squares += error * error;
    }
    const double mean = sum / kPixels;
    return {mean, std::sqrt(squares / kPixels - mean * mean)};
}

TEST(DepthSensor, IsIdealByDefault) {
    for (const double depth : {1e-3, 1.0, 1234.5}) {
        EXPECT_EQ(measured_depth(depth, 1.0, 7, {}), depth);
        EXPECT_EQ(measured_depth(depth, 0.2, 8, {}), depth);
    }
}

TEST(DepthSensor, NoiseHasTheStatedDeviation) {
    const auto [mean, deviation] = statistics(500.0, {.noise = 2.0});
    EXPECT_NEAR(mean, 0.0, 0.04);
    EXPECT_NEAR(deviation, 2.0, 0.03);
}

TEST(DepthSensor, TriangulationNoiseGrowsWithDepthSquared) {
    const SensorSettings settings{.noise = 0.1, .noise_per_depth2 = 0.01};
    EXPECT_NEAR(statistics(2.0, settings).second, 0.14, 0.003);
    EXPECT_NEAR(statistics(10.0, settings).second, 1.1, 0.02);
}

TEST(DepthSensor, QuantizationRoundsToMultiples) {
    const SensorSettings coarse{.quantization = 0.5};
    EXPECT_DOUBLE_EQ(measured_depth(10.2, 1.0, 0, coarse), 10.0);
    EXPECT_DOUBLE_EQ(measured_depth(10.3, 1.0, 0, coarse), 10.5);
    const SensorSettings noisy{.noise = 1.0, .quantization = 0.25};
    for (std::uint64_t pixel = 0; pixel < 1000; ++pixel) {
        const double steps = measured_depth(10.0, 1.0, pixel, noisy) / 0.25;
        ASSERT_DOUBLE_EQ(steps, std::round(steps));
    }
    // Rounding adds a variance of quantum^2 / 12.
    EXPECT_NEAR(statistics(10.0, noisy).second, std::sqrt(1.0 + 0.0625 / 12.0), 0.015);
}

TEST(DepthSensor, NothingReturnsAtGrazingAngles) {
    const SensorSettings settings{.max_grazing_angle = 1.0};
    EXPECT_FALSE(std::isnan(measured_depth(1.0, std::cos(0.99), 0, settings)));
    EXPECT_TRUE(std::isnan(measured_depth(1.0, std::cos(1.01), 0, settings)));
    EXPECT_TRUE(std::isnan(measured_depth(1.0, 0.0, 0, {})));
}

TEST(DepthSensor, NoiseDependsOnSeedAndPixelOnly) {
    const SensorSettings settings{.noise = 1.0, .seed = 3};
    SensorSettings other = settings;
    other.seed = 4;
    const double depth = measured_depth(9.0, 1.0, 5, settings);
    EXPECT_EQ(depth, measured_depth(9.0, 0.5, 5, settings));
    EXPECT_NE(depth, measured_depth(9.0, 1.0, 6, settings));
    EXPECT_NE(depth, measured_depth(9.0, 1.0, 5, other));
}

}  // namespace
}  // namespace ostraka
