// SPDX-License-Identifier: Apache-2.0
#include "ostraka/segmentation/rectangle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

Vec2d across(const Rectangle& rectangle) {
    return {-rectangle.along.y(), rectangle.along.x()};
}

TEST(SmallestRectangle, IsTheRectangleThatPointsFill) {
    const Vec2d along(std::cos(0.4), std::sin(0.4));
    const Vec2d side(-along.y(), along.x());
    std::vector<Vec2d> points;
    for (int i = -20; i <= 20; ++i) {
        for (int j = -5; j <= 5; ++j) points.push_back(Vec2d(3, 7) + i * along + j * side);
    }
    const Rectangle rectangle = smallest_rectangle(points);
    EXPECT_NEAR(rectangle.extents.x(), 40.0, 1e-9);
    EXPECT_NEAR(rectangle.extents.y(), 10.0, 1e-9);
    EXPECT_NEAR(std::abs(rectangle.along.dot(along)), 1.0, 1e-9);
    EXPECT_NEAR((rectangle.center - Vec2d(3, 7)).norm(), 0.0, 1e-9);
}

// Oracle: rectangles at 2000 angles, none of which is smaller.
TEST(SmallestRectangle, HoldsAllPointsAndIsSmallerThanAnyOther) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Random random(seed);
        std::vector<Vec2d> points;
        for (int i = 0; i < 60; ++i) points.emplace_back(random.normal(), 2.0 * random.normal());
        const Rectangle best = smallest_rectangle(points);
        EXPECT_GE(best.extents.x(), best.extents.y());
        for (const Vec2d& point : points) {
            const Vec2d offset = point - best.center;
            EXPECT_LE(std::abs(offset.dot(best.along)), 0.5 * best.extents.x() + 1e-9);
            EXPECT_LE(std::abs(offset.dot(across(best))), 0.5 * best.extents.y() + 1e-9);
        }
        double least = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 2000; ++k) {
            const double angle = 0.5 * 3.14159265358979 * k / 2000;
            const Vec2d u(std::cos(angle), std::sin(angle));
            Vec2d low = Vec2d::Constant(1e9);
            Vec2d high = Vec2d::Constant(-1e9);
            for (const Vec2d& p : points) {
                const Vec2d local(p.dot(u), p.x() * -u.y() + p.y() * u.x());
                low = low.cwiseMin(local);
                high = high.cwiseMax(local);
            }
            least = std::min(least, (high - low).prod());
        }
        EXPECT_LE(best.extents.prod(), least + 1e-9);
        EXPECT_GT(best.extents.prod(), 0.98 * least);
    }
}

TEST(SmallestRectangle, OfOnePointOrALineIsFlat) {
    const Rectangle point = smallest_rectangle({Vec2d(2, 3)});
    EXPECT_EQ(point.center, Vec2d(2, 3));
    EXPECT_EQ(point.extents, Vec2d(0, 0));
    const Rectangle line = smallest_rectangle({Vec2d(0, 0), Vec2d(3, 4), Vec2d(1.5, 2)});
    EXPECT_NEAR(line.extents.x(), 5.0, 1e-9);
    EXPECT_NEAR(line.extents.y(), 0.0, 1e-9);
    EXPECT_NEAR(smallest_rectangle({Vec2d(1, 1), Vec2d(1, 1)}).extents.norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace ostraka
