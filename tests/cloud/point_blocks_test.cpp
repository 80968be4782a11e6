// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/point_blocks.hpp"

#include <gtest/gtest.h>

#include "cloud/test_clouds.hpp"
#include "descriptors/shapes.hpp"
#include "ostraka/cloud/resample.hpp"

namespace ostraka {
namespace {

std::vector<std::size_t> found(std::span<const Vec3f> points, const Vec3f& center, float radius) {
    std::vector<std::size_t> indices;
    PointBlocks(points).for_each_within(points, center, radius,
                                        [&](std::size_t i) { indices.push_back(i); });
    return indices;
}

std::vector<std::size_t> expected(std::span<const Vec3f> points, const Vec3f& center,
                                  float radius) {
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if ((points[i] - center).squaredNorm() < radius * radius) indices.push_back(i);
    }
    return indices;
}

TEST(PointBlocks, AgreesWithBruteForceInOrder) {
    Random random(3);
    for (const PointCloud& shape : shapes::all(3001)) {
        // In the order of cells, and in none.
        for (const PointCloud& cloud : {resample(shape, 2.0), shape}) {
            for (int i = 0; i < 50; ++i) {
                const Vec3f center = cloud.points[random.below(cloud.size())] +
                                     Vec3d(10.0 * random.direction()).cast<float>();
                const auto radius = static_cast<float>(random.uniform(0.5, 60.0));
                EXPECT_EQ(found(cloud.points, center, radius),
                          expected(cloud.points, center, radius));
            }
        }
    }
}

TEST(PointBlocks, ABallMayHoldNothingOrAll) {
    const std::vector<Vec3f> points(100, Vec3f(1.0F, 2.0F, 3.0F));
    EXPECT_TRUE(found({}, Vec3f::Zero(), 1.0F).empty());
    EXPECT_TRUE(found(points, Vec3f::Zero(), 3.7F).empty());
    EXPECT_EQ(found(points, Vec3f::Zero(), 3.8F).size(), points.size());
    // The ball is open.
    EXPECT_TRUE(found(points, Vec3f(1.0F, 2.0F, 0.0F), 3.0F).empty());
}

}  // namespace
}  // namespace ostraka
