// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/gasd_color.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

PointCloud painted(PointCloud cloud, const Color& color) {
    cloud.colors.assign(cloud.size(), color);
    return cloud;
}

TEST(GasdColor, HueGoesAroundTheColorWheel) {
    EXPECT_EQ(hue_of({255, 0, 0}), 0.0F);
    EXPECT_EQ(hue_of({200, 200, 0}), 60.0F);
    EXPECT_EQ(hue_of({0, 7, 0}), 120.0F);
    EXPECT_EQ(hue_of({0, 90, 90}), 180.0F);
    EXPECT_EQ(hue_of({10, 10, 11}), 240.0F);
    EXPECT_EQ(hue_of({255, 0, 255}), 300.0F);
    EXPECT_NEAR(hue_of({255, 0, 1}), 360.0F - 60.0F / 255.0F, 1e-4F);
    EXPECT_EQ(hue_of({0, 0, 0}), 0.0F);
    EXPECT_EQ(hue_of({128, 128, 128}), 0.0F);
}

TEST(GasdColor, OnlyTheHuesOfTheColorsAreFilled) {
    const auto row = describe_gasd_color(painted(shapes::cut_torus(1'000), {0, 200, 20}));
    const double shape = std::accumulate(row.begin(), row.begin() + 216, 0.0);
    const double color = std::accumulate(row.begin() + 216, row.end(), 0.0);
    EXPECT_NEAR(shape, 100.0, 0.5);
    EXPECT_NEAR(color, 100.0, 0.5);
    double green = 0.0;
    for (std::size_t cell = 0; cell < 64; ++cell) green += double{row[216 + 12 * cell + 4]};
    EXPECT_NEAR(green, color, 1e-3);
}

TEST(GasdColor, ColorsTellEqualShapesApart) {
    PointCloud half = painted(shapes::bumpy_ellipsoid(2'000), {255, 0, 0});
    const auto red = describe_gasd_color(half);
    for (std::size_t i = 0; i < half.size(); ++i) {
        if (half.points[i].x() > 0.0F) half.colors[i] = {0, 0, 255};
    }
    const auto both = describe_gasd_color(half);
    EXPECT_TRUE(std::equal(red.begin(), red.begin() + 216, both.begin()));
    EXPECT_GT(shapes::relative_l1(both, red), 0.3);
}

TEST(GasdColor, CellsLieAlongTheAxesOfTheFrame) {
    // A bar of 13 points along x, with a short tail of y and z; seen from +z.
    PointCloud cloud;
    for (int i = -6; i <= 6; ++i) {
        cloud.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
        cloud.colors.push_back(i < 0 ? Color{255, 0, 0} : Color{0, 255, 0});
    }
    cloud.points.emplace_back(0.0F, 0.3F, 0.0F);
    cloud.points.emplace_back(0.0F, -0.3F, 0.0F);
    cloud.colors.resize(15, Color{0, 255, 0});
    cloud.viewpoint = Vec3f(0, 0, 50);
    const auto row = describe_gasd_color(cloud);
    // Shares by x alone: four slices of 4 x 12 x 4 = 192 values of color.
    const auto slice = [&](std::size_t x, std::size_t hue) {
        double sum = 0.0;
        for (std::size_t c = 0; c < 16; ++c) sum += double{row[216 + (16 * x + c) * 12 + hue]};
        return sum * 14.0 / 100.0;
    };
    // The middle of the bar may be at either end: compare the two ends as a set.
    const double reds = slice(0, 0) + slice(1, 0) + slice(2, 0) + slice(3, 0);
    EXPECT_NEAR(reds, 6.0, 1.001);
    EXPECT_NEAR(std::min(slice(0, 0) + slice(1, 0), slice(2, 0) + slice(3, 0)), 0.0, 1e-3);
}

TEST(GasdColor, CloudsWithoutColorsAreRejected) {
    EXPECT_THROW(describe_gasd_color(shapes::cut_torus(100)), InvalidInput);
    EXPECT_THROW(describe_gasd_color({}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
