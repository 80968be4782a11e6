// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/intervals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

// A binomial rate's 95 % interval is about 1.96 standard errors to either side.
TEST(BootstrapRatio, AgreesWithTheBinomialIntervalOfIndependentTrials) {
    std::vector<double> parts(400);
    for (std::size_t i = 0; i < parts.size(); ++i) parts[i] = i % 4 == 0 ? 1.0 : 0.0;
    const std::vector<double> wholes(400, 1.0);
    const Interval interval = bootstrap_ratio(parts, wholes);
    EXPECT_DOUBLE_EQ(interval.value, 0.25);
    const double error = std::sqrt(0.25 * 0.75 / 400.0);
    EXPECT_NEAR(interval.low, 0.25 - 1.96 * error, 0.2 * error);
    EXPECT_NEAR(interval.high, 0.25 + 1.96 * error, 0.2 * error);
}

TEST(BootstrapRatio, TakesTheObjectsOfAClusterAsOneDraw) {
    // The same 400 objects in 100 scenes of four that are alike: twice the error.
    std::vector<double> parts(100, 0.0);
    for (std::size_t i = 0; i < parts.size(); i += 4) parts[i] = 4.0;
    const std::vector<double> wholes(100, 4.0);
    const Interval interval = bootstrap_ratio(parts, wholes);
    EXPECT_DOUBLE_EQ(interval.value, 0.25);
    EXPECT_NEAR(interval.high - interval.low, 2.0 * 1.96 * std::sqrt(0.25 * 0.75 / 100.0), 0.02);
}

// An interval of 95 % holds the true rate in about 95 of 100 experiments.
TEST(BootstrapRatio, HoldsTheTruthAsOftenAsItSays) {
    int held = 0;
    for (std::uint64_t experiment = 0; experiment < 300; ++experiment) {
        Random random(7, experiment);
        std::vector<double> parts(60);
        for (double& part : parts) part = random.uniform() < 0.6 ? 1.0 : 0.0;
        const Interval interval =
            bootstrap_ratio(parts, std::vector<double>(60, 1.0), experiment, 400);
        if (interval.low <= 0.6 && 0.6 <= interval.high) ++held;
    }
    EXPECT_GT(held, 270);
    EXPECT_LT(held, 299);
}

TEST(BootstrapRatio, KnowsDifferencesAndNothing) {
    const std::vector<double> better = {1.0, 0.0, 1.0, 1.0};
    const Interval gain = bootstrap_ratio(better, std::vector<double>(4, 1.0));
    EXPECT_DOUBLE_EQ(gain.value, 0.75);
    EXPECT_EQ(bootstrap_ratio({}, {}).high, 0.0);
    const std::vector<double> zeros(3, 0.0);
    EXPECT_EQ(bootstrap_ratio(zeros, zeros).value, 0.0);
    const Interval certain =
        bootstrap_ratio(std::vector<double>(5, 2.0), std::vector<double>(5, 2.0));
    EXPECT_EQ(certain.low, 1.0);
    EXPECT_EQ(certain.high, 1.0);
}

// Most scenes hold nothing of what is asked for: they must not pull the interval to 0.
TEST(BootstrapRatio, LeavesOutDrawsThatSayNothing) {
    std::vector<double> parts(50, 0.0);
    std::vector<double> wholes(50, 0.0);
    parts[7] = wholes[7] = 2.0;
    const Interval interval = bootstrap_ratio(parts, wholes);
    EXPECT_EQ(interval.value, 1.0);
    EXPECT_EQ(interval.low, 1.0);
    EXPECT_EQ(interval.high, 1.0);
}

TEST(BootstrapMedian, LiesAmongTheValues) {
    std::vector<double> values;
    for (int i = 0; i < 101; ++i) values.push_back(i);
    const Interval interval = bootstrap_median(values);
    EXPECT_DOUBLE_EQ(interval.value, 50.0);
    // The median's order statistics at 95 %: 50 -+ 1.96 * sqrt(101) / 2.
    EXPECT_NEAR(interval.low, 50.0 - 9.8, 3.0);
    EXPECT_NEAR(interval.high, 50.0 + 9.8, 3.0);
    EXPECT_EQ(bootstrap_median({}).value, 0.0);
}

TEST(Bootstrap, IsTheSameForTheSameSeed) {
    const std::vector<double> parts = {0, 1, 1, 0, 1, 1, 1, 0};
    const std::vector<double> wholes(8, 1.0);
    const Interval a = bootstrap_ratio(parts, wholes, 3);
    const Interval b = bootstrap_ratio(parts, wholes, 3);
    EXPECT_EQ(a.low, b.low);
    EXPECT_EQ(a.high, b.high);
}

}  // namespace
}  // namespace ostraka
