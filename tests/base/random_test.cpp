// SPDX-License-Identifier: Apache-2.0
#include "ostraka/base/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <vector>

namespace ostraka {
namespace {

constexpr int kDraws = 200'000;

// Mean, variance, skewness and excess kurtosis.
std::array<double, 4> moments(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    double mean = 0.0;
    for (const double value : values) mean += value / count;
    std::array<double, 5> central{};
    for (const double value : values) {
        for (int power = 2; power <= 4; ++power) {
            central[static_cast<std::size_t>(power)] += std::pow(value - mean, power) / count;
        }
    }
    const double variance = central[2];
    return {mean, variance, central[3] / std::pow(variance, 1.5),
            central[4] / (variance * variance) - 3.0};
}

// A change of any of these numbers changes every library and every scene made so far.
TEST(Random, IsTheSameOnEveryPlatform) {
    Random bits(1, 2);
    const std::array<std::uint32_t, 4> expected_bits = {3406297099U, 3025492616U, 218436756U,
                                                        270908176U};
    for (const std::uint32_t expected : expected_bits) EXPECT_EQ(bits.bits(), expected);
    Random mixed(42);
    EXPECT_EQ(mixed.uniform(), 0.22501525087765939);
    EXPECT_EQ(mixed.uniform(-3.0, 5.0), 2.5235159933116957);
    EXPECT_EQ(mixed.below(1000), 7U);
    // Through log, sin and cos, which may differ in the last bit between C libraries.
    EXPECT_NEAR(mixed.normal(), 0.11173931846666765, 1e-14);
    const Vec3d direction = mixed.direction();
    EXPECT_NEAR(direction.x(), -0.073144733807509604, 1e-14);
    EXPECT_NEAR(direction.y(), 0.019549690951281336, 1e-14);
    EXPECT_NEAR(direction.z(), -0.99712970946609447, 1e-14);
    EXPECT_NEAR(mixed.rotation()(0, 1), 0.70429279182666316, 1e-14);
}

TEST(Random, SameSeedAndItemGiveTheSameStream) {
    Random a(7, 3);
    Random b(7, 3);
    for (int i = 0; i < 100; ++i) ASSERT_EQ(a.bits(), b.bits());
}

TEST(Random, StreamsOfDifferentSeedsAndItemsDiffer) {
    std::set<std::uint32_t> first;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        for (std::uint64_t item = 0; item < 40; ++item) first.insert(Random(seed, item).bits());
    }
    // 1600 draws of 2^32 collide with a chance of 3e-4.
    EXPECT_EQ(first.size(), 1600U);
}

TEST(Random, StreamsOfNeighboringItemsAreUncorrelated) {
    double product = 0.0;
    for (std::uint64_t item = 0; item < kDraws; ++item) {
        product += (Random(5, item).uniform() - 0.5) * (Random(5, item + 1).uniform() - 0.5);
    }
    // Deviation of the sum: sqrt(n) / 12; six of them.
    EXPECT_LT(std::abs(product), 6.0 * std::sqrt(double{kDraws}) / 12.0);
}

TEST(Random, EveryBitIsFair) {
    Random random(11);
    std::array<int, 32> ones{};
    for (int i = 0; i < kDraws; ++i) {
        const std::uint32_t value = random.bits();
        for (std::size_t bit = 0; bit < 32; ++bit) ones[bit] += (value >> bit & 1U) != 0U ? 1 : 0;
    }
    const double deviation = std::sqrt(kDraws / 4.0);
    for (const int count : ones) EXPECT_NEAR(count, kDraws / 2.0, 5.0 * deviation);
}

TEST(Random, UniformHasTheMomentsOfTheUnitInterval) {
    Random random(1);
    std::vector<double> values;
    for (int i = 0; i < kDraws; ++i) {
        values.push_back(random.uniform());
        ASSERT_GE(values.back(), 0.0);
        ASSERT_LT(values.back(), 1.0);
    }
    const auto [mean, variance, skewness, kurtosis] = moments(values);
    EXPECT_NEAR(mean, 0.5, 0.004);
    EXPECT_NEAR(variance, 1.0 / 12.0, 0.001);
    EXPECT_NEAR(skewness, 0.0, 0.02);
    EXPECT_NEAR(kurtosis, -1.2, 0.02);
}

TEST(Random, UniformFillsItsRange) {
    Random random(2);
    double low = 10.0;
    double high = -10.0;
    for (int i = 0; i < kDraws; ++i) {
        const double value = random.uniform(-3.0, 5.0);
        low = std::min(low, value);
        high = std::max(high, value);
    }
    EXPECT_GE(low, -3.0);
    EXPECT_LT(high, 5.0);
    EXPECT_NEAR(low, -3.0, 1e-3);
    EXPECT_NEAR(high, 5.0, 1e-3);
}

TEST(Random, NormalHasTheMomentsOfTheBellCurve) {
    Random random(3);
    std::vector<double> values;
    for (int i = 0; i < kDraws; ++i) values.push_back(random.normal());
    const auto [mean, variance, skewness, kurtosis] = moments(values);
    EXPECT_NEAR(mean, 0.0, 0.012);
    EXPECT_NEAR(variance, 1.0, 0.018);
    EXPECT_NEAR(skewness, 0.0, 0.03);
    EXPECT_NEAR(kurtosis, 0.0, 0.06);
    int beyond_two = 0;
    for (const double value : values) beyond_two += std::abs(value) > 2.0 ? 1 : 0;
    EXPECT_NEAR(beyond_two / double{kDraws}, std::erfc(std::sqrt(2.0)), 0.0025);
}

TEST(Random, BelowIsUnbiased) {
    for (const std::uint32_t count : {1U, 2U, 7U, 10U}) {
        Random random(4, count);
        std::vector<int> seen(count, 0);
        for (int i = 0; i < kDraws; ++i) ++seen.at(random.below(count));
        const double expected = double{kDraws} / count;
        for (const int times : seen) EXPECT_NEAR(times, expected, 5.0 * std::sqrt(expected));
    }
}

// With 3 * 2^30 values a plain remainder would give the lowest 2^30 twice as often as the others.
TEST(Random, BelowIsUnbiasedForHugeCounts) {
    Random random(6);
    const std::uint32_t count = 3U << 30U;
    int lowest_third = 0;
    for (int i = 0; i < kDraws; ++i) lowest_third += random.below(count) < count / 3 ? 1 : 0;
    EXPECT_NEAR(lowest_third / double{kDraws}, 1.0 / 3.0, 0.006);
}

TEST(Random, DirectionsAreUniformOnTheSphere) {
    Random random(8);
    Vec3d mean = Vec3d::Zero();
    Mat3d second = Mat3d::Zero();
    int polar = 0;
    for (int i = 0; i < kDraws; ++i) {
        const Vec3d direction = random.direction();
        ASSERT_NEAR(direction.norm(), 1.0, 1e-12);
        mean += direction / kDraws;
        second += direction * direction.transpose() / kDraws;
        polar += direction.x() > 0.9 ? 1 : 0;
    }
    EXPECT_LT(mean.norm(), 0.008);
    EXPECT_LT((second - Mat3d::Identity() / 3.0).norm(), 0.01);
    // Archimedes: the area of a cap is proportional to its height.
    EXPECT_NEAR(polar / double{kDraws}, 0.05, 0.0025);
}

TEST(Random, RotationsAreUniform) {
    Random random(9);
    Mat3d mean = Mat3d::Zero();
    Mat3d squares = Mat3d::Zero();
    double angle_sum = 0.0;
    for (int i = 0; i < kDraws; ++i) {
        const Mat3d rotation = random.rotation();
        if (i % 1000 == 0) {
            ASSERT_LT((rotation * rotation.transpose() - Mat3d::Identity()).norm(), 1e-12);
            ASSERT_NEAR(rotation.determinant(), 1.0, 1e-12);
        }
        mean += rotation / kDraws;
        squares += rotation.cwiseAbs2() / kDraws;
        angle_sum += std::acos(std::clamp((rotation.trace() - 1.0) / 2.0, -1.0, 1.0));
    }
    EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.008);
    EXPECT_LT((squares - Mat3d::Constant(1.0 / 3.0)).cwiseAbs().maxCoeff(), 0.006);
    // The angle's density is (1 - cos a) / pi, its mean pi / 2 + 2 / pi.
    EXPECT_NEAR(angle_sum / kDraws, kPi / 2.0 + 2.0 / kPi, 0.01);
}

}  // namespace
}  // namespace ostraka
