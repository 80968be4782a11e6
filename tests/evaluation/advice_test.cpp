// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/advice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/evaluation/advice_page.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

SensorPreset preset(const char* name) {
    return *find_sensor_preset(name, Unit::millimeter);
}

TEST(SensorReach, FollowsFromFocalLengthNoiseAndSteps) {
    SensorPreset sensor = preset("ideal");
    sensor.camera.fx = 500.0;
    sensor.model.ranging.noise_per_depth2 = 1e-6;
    EXPECT_DOUBLE_EQ(sensor_reach(sensor, 1000.0).pitch, 2.0);
    EXPECT_DOUBLE_EQ(sensor_reach(sensor, 1000.0).deviation, 1.0);
    EXPECT_DOUBLE_EQ(sensor_reach(sensor, 2000.0).deviation, 4.0);
    sensor.model.ranging.quantization = std::sqrt(12.0);
    EXPECT_NEAR(sensor_reach(sensor, 1000.0).deviation, std::sqrt(2.0), 1e-12);
    sensor.model.inverse_depth_step = 2.0 * std::sqrt(12.0) * 1e-6;
    EXPECT_NEAR(sensor_reach(sensor, 1000.0).deviation, std::sqrt(5.0), 1e-12);
}

TEST(SensorReach, IsTheSameInEveryUnit) {
    for (const SensorPreset& mm : sensor_presets(Unit::millimeter)) {
        const SensorPreset m = *find_sensor_preset(mm.name, Unit::meter);
        EXPECT_NEAR(sensor_reach(mm, 700.0).pitch, 1000.0 * sensor_reach(m, 0.7).pitch, 1e-9);
        EXPECT_NEAR(sensor_reach(mm, 700.0).deviation, 1000.0 * sensor_reach(m, 0.7).deviation,
                    1e-9);
    }
}

TEST(AdviseSampling, IsOnePercentOfTheMedianBetweenItsLimits) {
    SensorPreset sensor = preset("ideal");
    sensor.camera.fx = 1000.0;
    const std::vector<double> diameters = {100.0, 120.0, 500.0};
    const SamplingAdvice usual = advise_sampling(sensor, 800.0, diameters);
    EXPECT_DOUBLE_EQ(usual.sampling, 1.2);
    EXPECT_FALSE(usual.conflict());
    EXPECT_DOUBLE_EQ(advise_sampling(sensor, 1700.0, diameters).sampling, 1.7);  // pixels
    const SamplingAdvice far = advise_sampling(sensor, 3000.0, diameters);
    EXPECT_TRUE(far.conflict());
    EXPECT_DOUBLE_EQ(far.sampling, 3.0);
    const std::vector<double> one_small = {20.0, 120.0, 500.0};
    EXPECT_DOUBLE_EQ(advise_sampling(sensor, 300.0, one_small).sampling, 0.4);  // smallest part
}

TEST(AdviseSampling, IsTwoDeviationsOfTheSmoothedDepthWhereNoiseDecides) {
    SensorPreset sensor = preset("ideal");
    sensor.camera.fx = 1000.0;
    sensor.model.ranging.noise = 20.0;
    const SamplingAdvice advice = advise_sampling(sensor, 1000.0, std::vector<double>{100.0});
    const double pixels = kPi * std::pow(4.0 * advice.noise / advice.pitch, 2.0);
    EXPECT_NEAR(advice.noise, 2.0 * 20.0 / std::sqrt(pixels), 1e-9);
    EXPECT_DOUBLE_EQ(advice.sampling, advice.noise);
}

TEST(DefaultDistances, AreWithinTheSensorsRangeAndShowEnoughOfTheParts) {
    const std::vector<double> diameters = {90.0, 120.0};
    for (const SensorPreset& sensor : sensor_presets(Unit::millimeter)) {
        const std::vector<double> distances = default_distances(sensor, diameters);
        ASSERT_FALSE(distances.empty());
        EXPECT_TRUE(std::is_sorted(distances.begin(), distances.end()));
        for (const double distance : distances) {
            EXPECT_GT(distance, sensor.model.min_depth) << sensor.name;
            EXPECT_LT(distance, sensor.model.max_depth) << sensor.name;
            EXPECT_GE(90.0 / sensor_reach(sensor, distance).pitch, 49.0) << sensor.name;
        }
    }
    EXPECT_EQ(default_distances(preset("structured-light-fine"), diameters),
              (std::vector<double>{490.0, 700.0, 980.0}));
}

SettingsTrial trial(std::uint64_t bytes, double low, double value) {
    return {.bytes = bytes, .rates = {{"fused", {value, low, 1.0}}}};
}

TEST(CheapestGood, TakesTheSmallestWithinTheIntervalOfTheBest) {
    EXPECT_EQ(cheapest_good(std::vector{trial(9, 0.85, 0.92), trial(5, 0.8, 0.86),
                                        trial(2, 0.7, 0.84), trial(6, 0.8, 0.9)}),
              1U);
    EXPECT_EQ(cheapest_good(std::vector{trial(9, 1.0, 1.0), trial(1, 0.9, 0.99)}), 0U);
    EXPECT_EQ(cheapest_good(std::vector{trial(3, 0.8, 0.9), trial(3, 0.8, 0.9)}), 0U);
    EXPECT_THROW(cheapest_good({}), InvalidInput);
}

// A part at two distances; hits of ten objects in each quarter.
PartAdvice part(std::vector<double> near, std::vector<double> far) {
    PartAdvice made{.name = "a", .diameter = 100.0, .pixels = {200.0, 50.0}};
    double distance = 400.0;
    for (const std::vector<double>& hits : {near, far}) {
        RecallBin all{distance, distance, 40, {}};
        std::vector<RecallBin> quarters;
        for (std::size_t q = 0; q < 4; ++q) {
            quarters.push_back({0.25 * q, 0.25 * (q + 1), 10, {hits[q] / 10.0, 0.0, 1.0}});
            all.recall.value += hits[q] / 40.0;
        }
        all.recall.high = all.recall.value + 0.1;
        made.by_distance.push_back(all);
        made.by_both.push_back(quarters);
        distance *= 2.0;
    }
    return made;
}

TEST(JudgePart, SaysHowMuchMayBeHiddenAndWhere) {
    const std::vector<std::string> names = {"a", "b"};
    const std::vector<double> nobody = {0.0, 0.0};
    PartAdvice good = part({10, 9, 5, 0}, {10, 9, 4, 0});
    judge_part(good, Unit::millimeter, names, nobody);
    EXPECT_EQ(good.verdict, "found reliably to 50 % hidden, at 400, 800 mm");
    EXPECT_EQ(good.outlook, Outlook::good);
    PartAdvice near = part({10, 10, 9, 0}, {1, 0, 0, 0});
    judge_part(near, Unit::millimeter, names, std::vector<double>{0.0, 3.0});
    EXPECT_EQ(near.verdict,
              "found reliably to 75 % hidden, at 400 mm; at 800 mm only 2 %; taken for b 3 times; "
              "only 50 pixels across at 800 mm");
    EXPECT_EQ(near.outlook, Outlook::mixed);
    PartAdvice bad = part({1, 0, 0, 0}, {0, 0, 0, 0});
    judge_part(bad, Unit::millimeter, names, nobody);
    EXPECT_EQ(bad.outlook, Outlook::bad);
    EXPECT_NE(bad.verdict.find("hardly ever"), std::string::npos);
}

AdviceSettings tiny() {
    AdviceSettings settings{.sensor = preset("structured-light-fine"), .distances = {500.0}};
    settings.sensor.camera = {400, 320, 425.0, 425.0, 199.5, 159.5};
    settings.scenes = 2;
    settings.objects = 3;
    settings.segment_scenes = 2;
    settings.viewpoints = 12;
    settings.compare = false;
    settings.library = testing::quick_settings();
    settings.library.sampling = 0.0;
    return settings;
}

TEST(Advise, IsTheSameForAnyNumberOfThreads) {
    std::vector<Advice> both;
    for (const int threads : {1, 2}) {
        set_thread_count(threads);
        both.push_back(advise(testing::simple_models(), tiny()));
    }
    set_thread_count(0);
    const Advice& a = both[0];
    const Advice& b = both[1];
    ASSERT_EQ(a.parts.size(), 2U);
    EXPECT_EQ(a.confusion, b.confusion);
    EXPECT_EQ(a.trials.front().bytes, b.trials.front().bytes);
    EXPECT_EQ(a.distances.front().summary.hits, b.distances.front().summary.hits);
    EXPECT_EQ(a.distances.front().example.pixels, b.distances.front().example.pixels);
    for (std::size_t m = 0; m < 2; ++m) {
        EXPECT_EQ(a.parts[m].verdict, b.parts[m].verdict);
        EXPECT_EQ(a.look_alikes[m].margin, b.look_alikes[m].margin);
        EXPECT_EQ(a.look_alikes[m].picture.pixels, b.look_alikes[m].picture.pixels);
        EXPECT_EQ(a.look_alikes[m].other, 1U - m);
    }
    EXPECT_DOUBLE_EQ(a.library.sampling, a.sampling.sampling);
    const std::string html = advice_page(a, tiny(), "ostraka build <parts>").html();
    EXPECT_NE(html.find("ostraka build &lt;parts&gt;"), std::string::npos);
}

TEST(Advise, RefusesWhatCannotBeAsked) {
    EXPECT_THROW(advise({}, tiny()), InvalidInput);
    AdviceSettings behind = tiny();
    behind.distances = {-1.0};
    EXPECT_THROW(advise(testing::simple_models(), behind), InvalidInput);
}

}  // namespace
}  // namespace ostraka
