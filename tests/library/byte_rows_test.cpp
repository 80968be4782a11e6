// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/byte_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

std::vector<std::uint8_t> random_bytes(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<std::uint8_t> bytes(count);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
    return bytes;
}

std::int32_t by_definition(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
}

TEST(SquaredDistance, IsTheSumOfSquaresForEveryLengthAndAlignment) {
    const std::vector<std::uint8_t> bytes = random_bytes(1000, 1);
    for (std::size_t length = 1; length <= 130; ++length) {
        for (const std::size_t shift : {0U, 1U, 7U}) {
            const auto a = std::span(bytes).subspan(shift, length);
            const auto b = std::span(bytes).subspan(500 - shift, length);
            ASSERT_EQ(squared_distance(a.data(), b.data(), length), by_definition(a, b)) << length;
        }
    }
}

TEST(SquaredDistance, OfTheLongestRowsDoesNotOverflow) {
    const std::vector<std::uint8_t> black(kMaxByteRowLength, 0);
    const std::vector<std::uint8_t> white(kMaxByteRowLength, 255);
    EXPECT_EQ(squared_distance(black.data(), white.data(), black.size()), 33'025 * 255 * 255);
    EXPECT_EQ(squared_distance(white.data(), black.data(), black.size()), 33'025 * 255 * 255);
}

TEST(SquaredDistances, AreThoseOfTheListedRows) {
    constexpr std::size_t kLength = 45;
    const std::vector<std::uint8_t> bytes = random_bytes(50 * kLength, 2);
    const ByteRows rows{bytes, kLength};
    const std::vector<std::uint8_t> query = random_bytes(kLength, 3);
    const std::vector<std::uint32_t> indices = {49, 0, 7, 7, 13, 48, 1, 2, 3};
    for (std::size_t count = 0; count <= indices.size(); ++count) {
        std::vector<std::int32_t> distances(count + 1, -1);
        squared_distances(rows, query.data(), std::span(indices).first(count), distances.data());
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_EQ(distances[i], by_definition(rows.row(indices[i]), query));
        }
        EXPECT_EQ(distances[count], -1);
    }
}

TEST(ExactNearest, AgreesWithSortingAllRowsForAnyNumberOfThreads) {
    // Few different distances, so that ties by index matter; more than one block of rows.
    constexpr std::size_t kLength = 5;
    std::vector<std::uint8_t> bytes = random_bytes(10'000 * kLength, 4);
    for (std::uint8_t& byte : bytes) byte %= 4;
    const ByteRows rows{bytes, kLength};
    const std::vector<std::uint8_t> query = {1, 3, 0, 2, 2};
    std::vector<RowMatch> all;
    for (std::uint32_t i = 0; i < rows.size(); ++i) {
        all.push_back({i, by_definition(rows.row(i), query)});
    }
    std::sort(all.begin(), all.end(), nearer);
    for (const int threads : {1, 2, 4}) {
        set_thread_count(threads);
        for (const std::size_t k : {0U, 1U, 10U, 5000U, 10'000U, 20'000U}) {
            const auto kept = static_cast<std::ptrdiff_t>(std::min<std::size_t>(k, all.size()));
            const std::vector<RowMatch> expected(all.begin(), all.begin() + kept);
            EXPECT_EQ(exact_nearest(rows, query, k), expected);
        }
    }
    set_thread_count(0);
}

TEST(ExactNearest, FindsNothingAmongNoRows) {
    const std::vector<std::uint8_t> query(8, 1);
    EXPECT_TRUE(exact_nearest({.bytes = {}, .length = 8}, query, 3).empty());
}

TEST(ExactNearest, RejectsRowsThatCanNotBeCompared) {
    const std::vector<std::uint8_t> bytes(24, 1);
    EXPECT_THROW(exact_nearest({bytes, 0}, bytes, 1), InvalidInput);
    EXPECT_THROW(exact_nearest({bytes, 7}, std::span(bytes).first(7), 1), InvalidInput);
    EXPECT_THROW(exact_nearest({bytes, 8}, std::span(bytes).first(7), 1), InvalidInput);
    EXPECT_THROW(check({{}, kMaxByteRowLength + 1}), InvalidInput);
    EXPECT_NO_THROW(check({{}, kMaxByteRowLength}));
}

TEST(Quantize, IsExactToHalfAStepAndDistancesFollow) {
    Random random(5);
    constexpr std::size_t kLength = 200;
    std::vector<float> values(2 * kLength);
    for (float& value : values) value = static_cast<float>(random.uniform(-0.3, 1.1));
    const ByteScale scale = choose_scale(values, 0.0);
    EXPECT_NEAR(scale.step, 1.4 / 255.0, 2e-4);
    const std::vector<std::uint8_t> bytes = quantize(values, scale);
    double exact = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float back = scale.low + scale.step * static_cast<float>(bytes[i]);
        EXPECT_NEAR(back, values[i], 0.501F * scale.step);
        if (i < kLength) exact += std::pow(double{values[i]} - double{values[i + kLength]}, 2);
    }
    const std::int32_t distance = squared_distance(bytes.data(), bytes.data() + kLength, kLength);
    EXPECT_NEAR(distance * std::pow(double{scale.step}, 2), exact, 0.01 * exact);
}

TEST(Quantize, ClampsWhatLiesBeyondTheScale) {
    const ByteScale scale{.low = -1.0F, .step = 0.5F};
    const float infinity = std::numeric_limits<float>::infinity();
    const std::vector<float> values = {
        -9.0F, -infinity, -1.0F, 0.0F, 200.0F, infinity, std::numeric_limits<float>::quiet_NaN()};
    EXPECT_EQ(quantize(values, scale), (std::vector<std::uint8_t>{0, 0, 0, 2, 255, 255, 0}));
}

TEST(DecodedDistances, AreThoseOfDecodedRowsFromTheUnroundedQuery) {
    Random random(6);
    constexpr std::size_t kLength = 43;
    const std::vector<std::uint8_t> bytes = random_bytes(20 * kLength, 7);
    const ByteRows rows{bytes, kLength};
    const ByteScale scale{.low = -0.2F, .step = 0.004F};
    std::vector<float> query(kLength);
    for (float& value : query) value = static_cast<float>(random.uniform(-0.3, 0.9));
    const std::vector<RowMatch> matches = {{19, 0}, {0, 5}, {7, 0}};
    const std::vector<float> distances = decoded_distances(rows, scale, query, matches);
    ASSERT_EQ(distances.size(), matches.size());
    for (std::size_t i = 0; i < matches.size(); ++i) {
        double sum = 0.0;
        for (std::size_t d = 0; d < kLength; ++d) {
            const double value = -0.2 + 0.004 * rows.row(matches[i].row)[d];
            sum += (query[d] - value) * (query[d] - value);
        }
        EXPECT_NEAR(distances[i], std::sqrt(sum), 1e-5);
    }
    const std::vector<RowMatch> beyond = {{20, 0}};
    EXPECT_THROW(decoded_distances(rows, scale, query, beyond), InvalidInput);
    EXPECT_THROW(decoded_distances(rows, scale, std::span(query).first(42), matches), InvalidInput);
}

TEST(ChooseScale, StartsAtZeroWithoutNegativeValues) {
    const std::vector<float> values = {0.2F, 0.9F, 0.4F, 0.51F};
    const ByteScale scale = choose_scale(values, 0.0);
    EXPECT_EQ(scale.low, 0.0F);
    EXPECT_NEAR(scale.step, 0.9 / 255.0, 1e-7);
}

TEST(ChooseScale, ClipsOnlyTheShareAllowed) {
    std::vector<float> values;
    for (int i = 0; i <= 1000; ++i) values.push_back(static_cast<float>(i) * 1e-3F);
    values.push_back(50.0F);
    EXPECT_NEAR(choose_scale(values, 0.002).step * 255.0F, 1.0F, 2e-3F);
    EXPECT_NEAR(choose_scale(values, 0.0).step * 255.0F, 50.0F, 1e-3F);
    values.push_back(-70.0F);
    const ByteScale both = choose_scale(values, 0.002);
    EXPECT_NEAR(both.low, 0.0F, 4e-3F);
    EXPECT_NEAR(both.low + 255.0F * both.step, 1.0F, 4e-3F);
}

TEST(ChooseScale, CopesWithEqualFewAndTinyValues) {
    const std::vector<std::vector<float>> cases = {
        {}, {0.0F}, {3.0F, 3.0F}, {-3.0F, -3.0F}, {0.0F, 1e-45F}, {-1e38F, 1e38F}};
    for (const std::vector<float>& values : cases) {
        for (const double clipped : {0.0, 0.5}) {
            const ByteScale scale = choose_scale(values, clipped);
            EXPECT_TRUE(std::isfinite(scale.low));
            EXPECT_GT(scale.step, 0.0F);
            EXPECT_TRUE(std::isfinite(scale.step));
            const std::vector<std::uint8_t> bytes = quantize(values, scale);
            for (std::size_t i = 0; i < values.size(); ++i) {
                const float back = scale.low + scale.step * static_cast<float>(bytes[i]);
                EXPECT_NEAR(back, values[i], 0.51F * scale.step);
            }
        }
    }
}

TEST(ChooseScale, RejectsWhatIsNotFinite) {
    const std::vector<float> values = {0.0F, std::numeric_limits<float>::quiet_NaN()};
    EXPECT_THROW(choose_scale(values), InvalidInput);
    EXPECT_THROW(choose_scale({}, -0.1), InvalidInput);
    EXPECT_THROW(choose_scale({}, 0.6), InvalidInput);
}

}  // namespace
}  // namespace ostraka
