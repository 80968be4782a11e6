// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/metric.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace ostraka {
namespace {

constexpr std::array kMetrics = {Metric::l1, Metric::l2, Metric::chi_square, Metric::hellinger};

float between(const std::vector<float>& a, const std::vector<float>& b, Metric metric) {
    return distance(comparable_row(a, metric), comparable_row(b, metric), metric);
}

TEST(Metric, ClosedForms) {
    // 1/4 and 3/4 against 1/2 and 1/2.
    const std::vector<float> a = {1.0F, 3.0F};
    const std::vector<float> b = {2.0F, 2.0F};
    EXPECT_NEAR(between(a, b, Metric::l1), 0.5, 1e-6);
    EXPECT_NEAR(between(a, b, Metric::l2), std::sqrt(0.125), 1e-6);
    EXPECT_NEAR(between(a, b, Metric::chi_square), 0.0625 / 0.75 + 0.0625 / 1.25, 1e-6);
    const double root = std::sqrt(0.5);
    EXPECT_NEAR(between(a, b, Metric::hellinger), std::hypot(0.5 - root, std::sqrt(0.75) - root),
                1e-6);
}

TEST(Metric, DisjointRowsAreAsFarApartAsCanBe) {
    // 19 bins: more than two vectors and a rest.
    std::vector<float> a(19, 0.0F);
    std::vector<float> b(19, 0.0F);
    a[18] = 5.0F;
    b[3] = 7.0F;
    EXPECT_NEAR(between(a, b, Metric::l1), 2.0, 1e-6);
    EXPECT_NEAR(between(a, b, Metric::l2), std::sqrt(2.0), 1e-6);
    EXPECT_NEAR(between(a, b, Metric::chi_square), 2.0, 1e-6);
    EXPECT_NEAR(between(a, b, Metric::hellinger), std::sqrt(2.0), 1e-6);
}

TEST(Metric, ScaleSymmetryIdentityAndSigns) {
    std::vector<float> a;
    std::vector<float> b;
    for (int i = 0; i < 37; ++i) {
        a.push_back(std::sin(0.7F * static_cast<float>(i)));
        b.push_back(std::cos(0.3F * static_cast<float>(i)));
    }
    std::vector<float> scaled_a = a;
    for (float& value : scaled_a) value *= 4.0F;
    std::vector<float> opposite = a;
    for (float& value : opposite) value = -value;
    for (const Metric metric : kMetrics) {
        EXPECT_EQ(between(a, a, metric), 0.0F) << metric_name(metric);
        EXPECT_GT(between(a, b, metric), 0.01F) << metric_name(metric);
        EXPECT_EQ(between(a, b, metric), between(b, a, metric)) << metric_name(metric);
        EXPECT_EQ(between(a, scaled_a, metric), 0.0F) << metric_name(metric);
        EXPECT_GT(between(a, opposite, metric), between(a, b, metric)) << metric_name(metric);
    }
}

TEST(Metric, ZeroRowsStayFinite) {
    const std::vector<float> zero(12, 0.0F);
    const std::vector<float> one(12, 1.0F);
    for (const Metric metric : kMetrics) {
        EXPECT_EQ(between(zero, zero, metric), 0.0F);
        EXPECT_TRUE(std::isfinite(between(zero, one, metric)));
        EXPECT_GT(between(zero, one, metric), 0.0F);
    }
}

TEST(Metric, NamesGoBothWays) {
    for (const Metric metric : kMetrics) EXPECT_EQ(parse_metric(metric_name(metric)), metric);
    EXPECT_FALSE(parse_metric("cosine"));
}

}  // namespace
}  // namespace ostraka
