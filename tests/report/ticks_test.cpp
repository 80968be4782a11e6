// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/ticks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ostraka {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

PlotRange range_of(std::initializer_list<double> values) {
    PlotRange range;
    for (const double value : values) range.include(value);
    return range;
}

TEST(Ticks, StepsAreOneTwoOrFive) {
    for (double span = 1e-9; span < 1e12; span *= 1.37) {
        const double step = nice_step(span, 5);
        const double mantissa = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
        EXPECT_TRUE(std::abs(mantissa - 1.0) < 1e-9 || std::abs(mantissa - 2.0) < 1e-9 ||
                    std::abs(mantissa - 5.0) < 1e-9)
            << span << " " << step;
        EXPECT_GT(span / step, 2.9) << span;
        EXPECT_LT(span / step, 8.1) << span;
    }
}

TEST(Ticks, DataAreRoundedOutward) {
    const PlotAxis axis = make_axis(range_of({0.13, 0.87}), {}, false);
    EXPECT_EQ(axis.low, 0.0);
    EXPECT_EQ(axis.high, 1.0);
    EXPECT_EQ(axis.ticks, std::vector<double>({0.0, 0.2, 0.4, 0.6, 0.8, 1.0}));
    EXPECT_DOUBLE_EQ(axis.share(0.25), 0.25);
    const PlotAxis below = make_axis(range_of({-37.0, 12.0}), {}, false);
    EXPECT_EQ(below.ticks, std::vector<double>({-40.0, -30.0, -20.0, -10.0, 0.0, 10.0, 20.0}));
}

TEST(Ticks, AGivenRangeIsKeptExactly) {
    const PlotAxis axis = make_axis(range_of({5.0}), std::pair(0.25, 1.05), false);
    EXPECT_EQ(axis.low, 0.25);
    EXPECT_EQ(axis.high, 1.05);
    EXPECT_EQ(axis.ticks, std::vector<double>({0.4, 0.6, 0.8, 1.0}));
    const PlotAxis impossible = make_axis(range_of({1.0, 2.0}), std::pair(3.0, kNan), false);
    EXPECT_EQ(impossible.low, 1.0);
}

TEST(Ticks, OneValueOrNoneStillMakeAnAxis) {
    for (const PlotRange& range :
         {range_of({}), range_of({0.0}), range_of({-7.5}), range_of({1e15, 1e15 + 1.0}),
          range_of({1e-300}), range_of({0.0, 1e-200}), range_of({9e99, -9e99}),
          range_of({kNan, kInfinity, -kInfinity})}) {
        const PlotAxis axis = make_axis(range, {}, false);
        EXPECT_LT(axis.low, axis.high);
        EXPECT_GE(axis.ticks.size(), 3U);
        EXPECT_LE(axis.ticks.size(), 12U);
        for (const double tick : axis.ticks) EXPECT_TRUE(std::isfinite(tick));
    }
}

TEST(Ticks, LabelsHaveTheDecimalsOfTheirStep) {
    EXPECT_EQ(tick_label(0.30000000000000004, 0.1, false), "0.3");
    EXPECT_EQ(tick_label(0.5, 0.25, false), "0.5");
    EXPECT_EQ(tick_label(20.0, 10.0, false), "20");
    EXPECT_EQ(tick_label(-1e-17, 0.1, false), "0.0");
    EXPECT_EQ(tick_label(0.8, 0.2, true), "80 %");
    EXPECT_EQ(tick_label(0.985, 0.005, true), "98.5 %");
    EXPECT_EQ(tick_label(20000000.0, 1e7, false), "2e+07");
    EXPECT_EQ(tick_label(2e-7, 1e-7, false), "2e-07");
}

TEST(Ticks, ValuesAreShownWithThreeDigits) {
    EXPECT_EQ(value_label(0.98765, true), "98.8 %");
    EXPECT_EQ(value_label(0.98765, false), "0.988");
    EXPECT_EQ(value_label(12.345, false), "12.3");
    EXPECT_EQ(value_label(1234.5, false), "1234");
    EXPECT_EQ(value_label(7.0, false), "7");
    EXPECT_EQ(value_label(kNan, true), "none");
}

}  // namespace
}  // namespace ostraka
