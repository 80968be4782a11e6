// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/viewpoints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

// Angle from each direction to the nearest other one: least and greatest.
std::pair<double, double> gaps(const std::vector<Vec3d>& directions) {
    double least = kPi;
    double greatest = 0.0;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        double nearest = kPi;
        for (std::size_t j = 0; j < directions.size(); ++j) {
            if (j == i) continue;
            nearest = std::min(nearest, std::atan2(directions[i].cross(directions[j]).norm(),
                                                   directions[i].dot(directions[j])));
        }
        least = std::min(least, nearest);
        greatest = std::max(greatest, nearest);
    }
    return {least, greatest};
}

class Viewpoints : public testing::TestWithParam<int> {};

TEST_P(Viewpoints, AreUnitVectorsSpreadEvenly) {
    const std::vector<Vec3d> directions = viewpoints(GetParam());
    ASSERT_EQ(directions.size(), static_cast<std::size_t>(GetParam()));
    Vec3d mean = Vec3d::Zero();
    Mat3d second = Mat3d::Zero();
    for (const Vec3d& direction : directions) {
        EXPECT_NEAR(direction.norm(), 1.0, 1e-12);
        mean += direction / GetParam();
        second += direction * direction.transpose() / GetParam();
    }
    EXPECT_LT(mean.norm(), 1e-12);
    EXPECT_LT((second - Mat3d::Identity() / 3.0).norm(), 1e-12) << "icosahedral symmetry";
    const auto [least, greatest] = gaps(directions);
    const double ideal = std::sqrt(4.0 * kPi / GetParam());
    EXPECT_GT(least, 0.6 * ideal);
    EXPECT_LT(greatest, 1.2 * ideal);
}

INSTANTIATE_TEST_SUITE_P(Counts, Viewpoints, testing::Values(12, 20, 42, 80, 162, 320, 642, 1280));

TEST(ViewpointsOf, TheIcosahedronAndItsDualHaveTheirKnownAngles) {
    const auto [vertex_least, vertex_greatest] = gaps(viewpoints(12));
    EXPECT_NEAR(vertex_least, std::atan(2.0), 1e-12);
    EXPECT_NEAR(vertex_greatest, std::atan(2.0), 1e-12);
    // Face centers: a dodecahedron's vertices, acos(sqrt(5) / 3) apart.
    const auto [face_least, face_greatest] = gaps(viewpoints(20));
    EXPECT_NEAR(face_least, std::acos(std::sqrt(5.0) / 3.0), 1e-12);
    EXPECT_NEAR(face_greatest, std::acos(std::sqrt(5.0) / 3.0), 1e-12);
}

TEST(ViewpointsOf, FinerVerticesHoldTheCoarserOnes) {
    const std::vector<Vec3d> coarse = viewpoints(42);
    const std::vector<Vec3d> fine = viewpoints(162);
    for (std::size_t i = 0; i < coarse.size(); ++i) EXPECT_EQ(coarse[i], fine[i]);
}

TEST(ViewpointsOf, OtherCountsAreRejected) {
    for (const int count : {-1, 0, 1, 13, 30, 43, 100, 5000}) {
        EXPECT_THROW(viewpoints(count), InvalidInput) << count;
    }
    EXPECT_EQ(viewpoints(2562).size(), 2562U);
}

}  // namespace
}  // namespace ostraka
