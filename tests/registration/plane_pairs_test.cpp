// SPDX-License-Identifier: Apache-2.0
#include "ostraka/registration/plane_pairs.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

// Sums of `count` random pairs, and what Eigen makes of the same.
void expect_sums(std::size_t count, PlanePairs& pairs) {
    Random random(count);
    Mat6d left = Mat6d::Zero();
    Vec6d right = Vec6d::Zero();
    double squares = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d turn = random.uniform(0.1, 5.0) * random.direction();
        const Vec3d normal = random.direction();
        const double residual = random.uniform(-1.0, 1.0);
        pairs.add(turn, normal, residual);
        Vec6d row;
        row << turn, normal;
        left += row * row.transpose();
        right -= residual * row;
        squares += residual * residual;
    }
    EXPECT_EQ(pairs.size(), count);
    const PlaneSums sums = pairs.take();
    EXPECT_EQ(sums.pairs(), count);
    EXPECT_EQ(pairs.size(), 0U);
    EXPECT_LE((sums.left() - left).norm(), 1e-12 * left.norm());
    EXPECT_LE((sums.right() - right).norm(), 1e-12 * left.norm());
    EXPECT_NEAR(sums.squares(), squares, 1e-12 * static_cast<double>(count + 1));
}

TEST(PlanePairs, SumsAreThoseOfTheNormalEquations) {
    PlanePairs pairs;  // one for all: what was taken must not come back
    for (const std::size_t count : {256U, 1U, 0U, 3U, 4U, 5U, 255U}) expect_sums(count, pairs);
}

TEST(PlaneSums, AddUp) {
    PlanePairs pairs;
    pairs.add(Vec3d(1.0, 2.0, 3.0), Vec3d::UnitX(), 0.5);
    PlaneSums sums = pairs.take();
    pairs.add(Vec3d(-1.0, 0.0, 2.0), Vec3d::UnitZ(), -2.0);
    sums += pairs.take();
    EXPECT_EQ(sums.pairs(), 2U);
    EXPECT_DOUBLE_EQ(sums.left()(0, 0), 2.0);
    EXPECT_DOUBLE_EQ(sums.left()(1, 2), 6.0);
    EXPECT_DOUBLE_EQ(sums.left()(2, 1), 6.0);
    EXPECT_DOUBLE_EQ(sums.left()(2, 5), 2.0);
    EXPECT_DOUBLE_EQ(sums.right()[0], -2.5);
    EXPECT_DOUBLE_EQ(sums.right()[5], 2.0);
    EXPECT_DOUBLE_EQ(sums.squares(), 4.25);
}

}  // namespace
}  // namespace ostraka
