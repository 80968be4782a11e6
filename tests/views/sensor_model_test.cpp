// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/sensor_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/parallel.hpp"
#include "ostraka/views/sensor_presets.hpp"

namespace ostraka {
namespace {

constexpr int kSide = 320;
constexpr std::size_t kPixels = kSide * kSide;

DepthImage wall(double depth, double cosine = 1.0) {
    return {kSide, kSide, std::vector<double>(kPixels, depth),
            std::vector<double>(kPixels, cosine)};
}

// The left half near, the right half far.
DepthImage step(double near, double far) {
    DepthImage image = wall(near);
    for (std::size_t i = 0; i < kPixels; ++i) {
        if (i % kSide >= kSide / 2) image.depths[i] = far;
    }
    return image;
}

struct Moments {
    double mean = 0.0;
    double deviation = 0.0;
    double lost = 0.0;  // share of the pixels
};

Moments moments(const std::vector<double>& depths) {
    double sum = 0.0;
    double squares = 0.0;
    double count = 0.0;
    for (const double depth : depths) {
        if (depth == 0.0) continue;
        sum += depth;
        squares += depth * depth;
        count += 1.0;
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean)),
            1.0 - count / static_cast<double>(depths.size())};
}

Moments measure_wall(double depth, const SensorModel& sensor, double cosine = 1.0) {
    return moments(measured_depths(wall(depth, cosine), {}, sensor));
}

TEST(SensorModel, IsIdealByDefault) {
    for (const double depth : {1e-3, 1.0, 1234.5}) {
        EXPECT_EQ(measured_depths(wall(depth, 0.2), {}, {}), wall(depth).depths);
    }
}

TEST(SensorModel, NoiseHasTheStatedMoments) {
    const Moments constant = measure_wall(500.0, {.ranging = {.noise = 2.0}});
    EXPECT_NEAR(constant.mean, 500.0, 0.03);
    EXPECT_NEAR(constant.deviation, 2.0, 0.03);
    EXPECT_EQ(constant.lost, 0.0);
    SensorModel sensor{.ranging = {.noise = 0.01, .noise_per_depth2 = 0.001}};
    EXPECT_NEAR(measure_wall(2.0, sensor).deviation, 0.014, 0.0003);
    EXPECT_NEAR(measure_wall(10.0, sensor).deviation, 0.11, 0.002);
    sensor.noise_per_depth = 0.005;
    EXPECT_NEAR(measure_wall(10.0, sensor).deviation, 0.16, 0.002);
    sensor.grazing_noise = 1.0;
    EXPECT_NEAR(measure_wall(10.0, sensor, 0.5).deviation, 0.32, 0.004);
    sensor.grazing_noise = 2.0;
    EXPECT_NEAR(measure_wall(10.0, sensor, 0.5).deviation, 0.64, 0.008);
}

// The mean over windows of w x w pixels of white noise has this correlation at a lag of d columns:
// (w - d) / w.
TEST(SensorModel, NoiseOfAWindowKeepsItsDeviationAndIsAlikeWithinIt) {
    const SensorModel sensor{.ranging = {.noise = 2.0}, .noise_window = 5};
    const std::vector<double> depths = measured_depths(wall(100.0), {}, sensor);
    EXPECT_NEAR(moments(depths).deviation, 2.0, 0.05);
    for (const std::size_t lag : {1U, 3U, 5U, 9U}) {
        double sum = 0.0;
        double count = 0.0;
        for (std::size_t i = 0; i < kPixels; ++i) {
            if (i % kSide + lag >= kSide) continue;
            sum += (depths[i] - 100.0) * (depths[i + lag] - 100.0);
            count += 1.0;
        }
        const double expected = std::max(0.0, (5.0 - static_cast<double>(lag)) / 5.0);
        EXPECT_NEAR(sum / count / 4.0, expected, 0.05) << lag;
    }
}

TEST(SensorModel, RoundsDepthOrInverseDepth) {
    EXPECT_DOUBLE_EQ(measure_wall(10.2, {.ranging = {.quantization = 0.5}}).mean, 10.0);
    EXPECT_DOUBLE_EQ(measure_wall(10.3, {.ranging = {.quantization = 0.5}}).mean, 10.5);
    const SensorModel noisy{.ranging = {.noise = 1.0, .quantization = 0.25}};
    for (const double depth : measured_depths(wall(10.0), {}, noisy)) {
        ASSERT_DOUBLE_EQ(depth / 0.25, std::round(depth / 0.25));
    }
    // Rounding adds a variance of quantum^2 / 12.
    EXPECT_NEAR(measure_wall(10.0, noisy).deviation, std::sqrt(1.0 + 0.0625 / 12.0), 0.015);
    // At depth z one step of disparity is about z^2 steps of depth.
    const SensorModel disparity{.ranging = {.noise = 50.0}, .inverse_depth_step = 1e-5};
    for (const double depth : measured_depths(wall(2000.0), {}, disparity)) {
        const double steps = 1.0 / (depth * 1e-5);
        ASSERT_NEAR(steps, std::round(steps), 1e-9);
    }
    const double between = 1.0 / 50.5e-5;
    const double depth = measure_wall(between * 1.001, {.inverse_depth_step = 1e-5}).mean;
    EXPECT_NEAR(depth, 1.0 / 50e-5, 1e-9);
}

TEST(SensorModel, LosesGrazingSurface) {
    const SensorModel hard{.ranging = {.max_grazing_angle = 1.0}};
    EXPECT_EQ(measure_wall(1.0, hard, std::cos(0.99)).lost, 0.0);
    EXPECT_EQ(moments(measured_depths(wall(1.0, std::cos(1.01)), {}, hard)).lost, 1.0);
    const SensorModel soft{.ranging = {.max_grazing_angle = 1.4}, .free_grazing_angle = 1.0};
    EXPECT_EQ(measure_wall(1.0, soft, std::cos(0.99)).lost, 0.0);
    EXPECT_NEAR(measure_wall(1.0, soft, std::cos(1.1)).lost, 0.25, 0.01);
    EXPECT_NEAR(measure_wall(1.0, soft, std::cos(1.3)).lost, 0.75, 0.01);
}

TEST(SensorModel, LosesPixelsByChanceInHolesAndOutOfRange) {
    EXPECT_NEAR(measure_wall(1.0, {.dropout = 0.2}).lost, 0.2, 0.01);
    double share = 0.0;  // mean of many seeds: one image holds few holes
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        share += measure_wall(1.0, {.ranging = {.seed = seed}, .holes = 0.1}).lost / 20.0;
    }
    EXPECT_NEAR(share, 0.1, 0.01);
    const SensorModel ranged{.min_depth = 2.0, .max_depth = 4.0};
    EXPECT_EQ(measure_wall(1.9, ranged).lost, 1.0);
    EXPECT_EQ(measure_wall(3.0, ranged).lost, 0.0);
    EXPECT_EQ(measure_wall(4.1, ranged).lost, 1.0);
    std::vector<char> shadowed(kPixels, 0);
    std::fill(shadowed.begin(), shadowed.begin() + kPixels / 4, char{1});
    EXPECT_DOUBLE_EQ(moments(measured_depths(wall(1.0), shadowed, {})).lost, 0.25);
}

TEST(SensorModel, MixesAndLosesPixelsAtEdgesOnly) {
    const SensorModel sensor{.edge_step = 1.0, .edge_dropout = 0.25, .mixed_pixels = 0.5};
    const std::vector<double> depths = measured_depths(step(10.0, 20.0), {}, sensor);
    double lost = 0.0;
    double mixed = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < kPixels; ++i) {
        const std::size_t column = i % kSide;
        if (column != kSide / 2 - 1 && column != kSide / 2) {
            ASSERT_EQ(depths[i], column < kSide / 2 ? 10.0 : 20.0);
            continue;
        }
        lost += depths[i] == 0.0 ? 1.0 : 0.0;
        if (depths[i] > 10.0 && depths[i] < 20.0) {
            mixed += 1.0;
            sum += depths[i];
        }
    }
    EXPECT_NEAR(lost / (2.0 * kSide), 0.25, 0.06);
    EXPECT_NEAR(mixed / (2.0 * kSide), 0.5, 0.07);
    EXPECT_NEAR(sum / mixed, 15.0, 0.6);
    EXPECT_EQ(measured_depths(step(10.0, 10.9), {}, sensor), step(10.0, 10.9).depths);
}

TEST(SensorModel, DependsOnSeedOnlyForAnyNumberOfThreads) {
    SensorModel sensor = find_sensor_preset("stereo", Unit::millimeter)->model;
    const DepthImage image = step(500.0, 600.0);
    set_thread_count(1);
    const std::vector<double> one = measured_depths(image, {}, sensor);
    set_thread_count(2);
    EXPECT_EQ(measured_depths(image, {}, sensor), one);
    set_thread_count(0);
    sensor.ranging.seed = 1;
    EXPECT_NE(measured_depths(image, {}, sensor), one);
}

TEST(SensorPresets, AreTheSameInAnyUnit) {
    const std::vector<SensorPreset> in_mm = sensor_presets(Unit::millimeter);
    const std::vector<SensorPreset> in_m = sensor_presets(Unit::meter);
    ASSERT_EQ(in_mm.size(), in_m.size());
    for (std::size_t i = 0; i < in_mm.size(); ++i) {
        const DepthImage mm = step(700.0, 800.0);
        const DepthImage m = step(0.7, 0.8);
        const std::vector<double> a = measured_depths(mm, {}, in_mm[i].model);
        const std::vector<double> b = measured_depths(m, {}, in_m[i].model);
        for (std::size_t p = 0; p < kPixels; ++p) {
            // A depth just between two steps may round either way.
            ASSERT_NEAR(a[p], 1000.0 * b[p], in_mm[i].name == "ideal" ? 1e-9 : 2.5) << p;
        }
        EXPECT_NEAR(noise_deviation(700.0, 0.7, in_mm[i].model),
                    1000.0 * noise_deviation(0.7, 0.7, in_m[i].model), 1e-12);
    }
    EXPECT_FALSE(find_sensor_preset("kinect", Unit::meter));
}

// The makers' and the papers' numbers, worked out by hand.
TEST(SensorPresets, HaveThePublishedNoise) {
    const auto deviation = [](std::string_view name, double depth) {
        return noise_deviation(depth, 1.0, find_sensor_preset(name, Unit::millimeter)->model);
    };
    EXPECT_NEAR(deviation("structured-light", 1000.0), 1.425, 1e-9);
    EXPECT_NEAR(deviation("structured-light", 3000.0), 12.825, 1e-9);
    EXPECT_NEAR(deviation("stereo", 1000.0), 3.765, 1e-3);
    EXPECT_NEAR(deviation("time-of-flight", 1000.0), 1.0, 1e-9);
    EXPECT_NEAR(deviation("laser-line", 1000.0), 0.1, 1e-9);
    EXPECT_NEAR(deviation("structured-light-fine", 700.0), 0.0588, 1e-9);
    EXPECT_EQ(deviation("ideal", 700.0), 0.0);
}

}  // namespace
}  // namespace ostraka
