// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/spread.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kLength = 24;

std::vector<float> random_row(Random& random) {
    std::vector<float> row(kLength);
    for (float& value : row) value = static_cast<float>(random.uniform());
    return row;
}

float norm(const std::vector<float>& row) {
    double sum = 0.0;
    for (const float value : row) sum += double{value} * double{value};
    return static_cast<float>(std::sqrt(sum));
}

// center + a * along, for several a.
std::vector<float> line(const std::vector<float>& center, const std::vector<float>& along,
                        std::initializer_list<float> steps) {
    std::vector<float> rows;
    for (const float a : steps) {
        for (std::size_t i = 0; i < kLength; ++i) rows.push_back(center[i] + a * along[i]);
    }
    return rows;
}

TEST(Spread, OfOneRowIsThatRow) {
    Random random(1);
    const std::vector<float> row = random_row(random);
    const std::vector<float> other = random_row(random);
    Spread spread;
    append_spread(row, kLength, 3, spread);
    const SpreadIndex index(spread, kLength);
    EXPECT_NEAR(index.distances(row)[0], 0.0F, 1e-3F);
    std::vector<float> difference = row;
    for (std::size_t i = 0; i < kLength; ++i) difference[i] -= other[i];
    EXPECT_NEAR(index.distances(other)[0], norm(difference), 1e-4F);
}

// Rows on a segment of half-length h have a deviation of h times the root of their mean square
// step, and the patch reaches twice as far.
TEST(Spread, APatchIsTheSegmentThatItsRowsLieOn) {
    Random random(2);
    const std::vector<float> center = random_row(random);
    std::vector<float> along = random_row(random);
    const float length = norm(along);
    for (float& value : along) value /= length;
    Spread spread;
    append_spread(line(center, along, {-0.2F, -0.1F, 0.0F, 0.1F, 0.2F}), kLength, 3, spread);
    const SpreadIndex index(spread, kLength);
    const double reach = 2.0 * std::sqrt((0.04 + 0.01) * 2.0 / 5.0);
    for (const float a : {-0.9F, -0.28F, -0.1F, 0.0F, 0.25F, 0.6F}) {
        const double beyond = std::max(0.0, std::abs(double{a}) - reach);
        EXPECT_NEAR(index.distances(line(center, along, {a}))[0], beyond, 0.01) << a;
    }
}

TEST(Spread, APatchIsNeverFartherThanItsMeanNorDoesItReachBeyondItsRows) {
    Random random(3);
    Spread spread;
    std::vector<float> rows;
    for (int i = 0; i < 12; ++i) {
        const std::vector<float> row = random_row(random);
        rows.insert(rows.end(), row.begin(), row.end());
    }
    append_spread(rows, kLength, 3, spread);
    Spread point;
    append_spread(spread.means, kLength, 3, point);
    for (int trial = 0; trial < 50; ++trial) {
        const std::vector<float> query = random_row(random);
        const float to_patch = SpreadIndex(spread, kLength).distances(query)[0];
        EXPECT_LE(to_patch, SpreadIndex(point, kLength).distances(query)[0] + 1e-5F);
        EXPECT_GT(to_patch, 0.0F);
    }
}

TEST(Spread, PartsPutTogetherAreTheWhole) {
    Random random(4);
    Spread whole;
    for (int entry = 0; entry < 5; ++entry) {
        const std::vector<float> center = random_row(random);
        append_spread(line(center, random_row(random), {0.0F, 0.3F, 1.0F}), kLength, 3, whole);
    }
    Spread joined = whole.part(0, 2, kLength);
    joined.append(whole.part(2, 5, kLength));
    EXPECT_EQ(joined.means, whole.means);
    EXPECT_EQ(joined.directions, whole.directions);
    EXPECT_EQ(joined.scales, whole.scales);
    EXPECT_TRUE(Spread().part(0, 3, kLength).empty());
}

}  // namespace
}  // namespace ostraka
