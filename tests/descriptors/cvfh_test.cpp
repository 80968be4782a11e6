// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/cvfh.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/resample.hpp"

namespace ostraka {
namespace {

Pose some_motion() {
    Pose motion = Pose::Identity();
    motion.linear() = Random(8).rotation();
    motion.translation() = Vec3d(10.0, -20.0, 30.0);
    return motion;
}

float block_sum(const RegionalDescriptors& result, std::size_t row, std::size_t begin,
                std::size_t count) {
    const auto first = result.rows.begin() + static_cast<std::ptrdiff_t>(row * kCvfhLength + begin);
    return std::accumulate(first, first + static_cast<std::ptrdiff_t>(count), 0.0F);
}

TEST(SurfaceVariation, OfAPlaneIsZeroAndOfABallOneThird) {
    Random random(1);
    std::vector<Vec3f> plane;
    std::vector<Vec3f> ball = {Vec3f::Zero()};
    for (int i = 0; i < 3'000; ++i) {
        const double x = random.uniform(-1.0, 1.0);
        const double y = random.uniform(-1.0, 1.0);
        plane.push_back(Vec3d(x, y, 2.0 * x - y).cast<float>());
        const Vec3d inside(x, y, random.uniform(-1.0, 1.0));
        if (inside.norm() < 1.0) ball.push_back(inside.cast<float>());
    }
    for (const float variation : surface_variations(plane, 0.3F)) EXPECT_LE(variation, 1e-6F);
    EXPECT_NEAR(surface_variations(ball, 1.0F).front(), 1.0F / 3.0F, 0.02F);
}

TEST(SurfaceVariation, OfTooFewPointsIsZero) {
    const std::vector<Vec3f> points = {{0, 0, 0}, {1, 0, 0}, {50, 0, 0}};
    EXPECT_EQ(surface_variations(points, 2.0F), std::vector<float>(3, 0.0F));
    EXPECT_THROW(surface_variations(points, 0.0F), InvalidInput);
    EXPECT_TRUE(surface_variations({}, 1.0F).empty());
}

TEST(SmoothRegions, OfABoxAreItsFaces) {
    const PointCloud cloud = shapes::notched_box(6'000);
    const auto radius = static_cast<float>(5.0 * mesh_resolution(cloud.points));
    const auto regions = smooth_regions(cloud, {}, {.normal_radius = radius});
    ASSERT_EQ(regions.size(), 3U);
    for (const SmoothRegion& region : regions) {
        ASSERT_GE(region.points.size(), 500U);
        EXPECT_TRUE(std::is_sorted(region.points.begin(), region.points.end()));
        Vec3d mean = Vec3d::Zero();
        std::size_t facing = 0;
        for (const std::uint32_t i : region.points) {
            facing += region.normal.dot(cloud.normals[i]) > 0.999F ? 1 : 0;
            mean += cloud.points[i].cast<double>();
        }
        EXPECT_GE(facing + 3, region.points.size());  // on an edge a fit may choose either face
        mean /= static_cast<double>(region.points.size());
        EXPECT_LE((mean.cast<float>() - region.centroid).norm(), 1e-4F);
    }
    EXPECT_GE(regions[0].points.size(), regions[1].points.size());
    EXPECT_GE(regions[1].points.size(), regions[2].points.size());
}

TEST(SmoothRegions, RefinementKeepsWhatFacesAsTheMean) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(3'000);
    const auto whole = smooth_regions(cloud, {}, {.max_angle = 0.4F});
    const auto refined = smooth_regions(cloud, {}, {.max_angle = 0.4F}, 1.0F);
    ASSERT_FALSE(whole.empty());
    ASSERT_FALSE(refined.empty());
    EXPECT_GT(whole.front().points.size(), 2'000U);
    EXPECT_LT(refined.front().points.size(), whole.front().points.size() / 2);
    EXPECT_TRUE(std::includes(whole.front().points.begin(), whole.front().points.end(),
                              refined.front().points.begin(), refined.front().points.end()));
}

TEST(SmoothRegions, SmallOnesAreLeftOut) {
    const PointCloud cloud = shapes::notched_box(6'000);
    const std::size_t second = smooth_regions(cloud)[1].points.size();
    EXPECT_EQ(smooth_regions(cloud, {}, {.min_points = second}).size(), 2U);
    EXPECT_EQ(smooth_regions(cloud, {}, {.min_points = second + 1}).size(), 1U);
    EXPECT_TRUE(smooth_regions(cloud, {}, {.min_points = 6'001}).empty());
}

TEST(SmoothRegions, GivenCurvaturesReplaceComputedOnes) {
    const PointCloud cloud = shapes::notched_box(2'000);
    const auto radius = static_cast<float>(3.0 * mesh_resolution(cloud.points));
    const auto curvatures = surface_variations(cloud.points, radius);
    const auto computed = smooth_regions(cloud);
    const auto given = smooth_regions(cloud, curvatures);
    ASSERT_EQ(computed.size(), given.size());
    for (std::size_t r = 0; r < given.size(); ++r) {
        EXPECT_EQ(computed[r].points, given[r].points);
    }
    EXPECT_TRUE(smooth_regions(cloud, std::vector<float>(cloud.size(), 0.2F)).empty());
    EXPECT_THROW(smooth_regions(cloud, std::vector<float>(7)), InvalidInput);
}

TEST(SmoothRegions, BadSettingsAreRejected) {
    const PointCloud cloud = shapes::notched_box(100);
    EXPECT_THROW(smooth_regions(cloud, {}, {.normal_radius = -1.0F}), InvalidInput);
    EXPECT_THROW(smooth_regions(cloud, {}, {.tolerance = std::nanf("")}), InvalidInput);
    EXPECT_THROW(smooth_regions({}), InvalidInput);
}

TEST(Cvfh, BlocksSumToThePointsOrToOneHundred) {
    const PointCloud cloud = shapes::notched_box(3'000);
    const auto counted = describe_cvfh(cloud);
    const auto shared = describe_cvfh(cloud, {.normalize_bins = true});
    ASSERT_EQ(counted.rows.size(), counted.regions.size() * kCvfhLength);
    ASSERT_EQ(counted.rows.size(), shared.rows.size());
    for (std::size_t r = 0; r < counted.regions.size(); ++r) {
        EXPECT_EQ(counted.region_of_row[r], r);
        for (const std::size_t block : {0U, 45U, 90U, 135U}) {
            EXPECT_EQ(block_sum(counted, r, block, 45), 3'000.0F);
            EXPECT_NEAR(block_sum(shared, r, block, 45), 100.0F * 3'000.0F / 2'999.0F, 1e-3F);
        }
        EXPECT_EQ(block_sum(counted, r, 180, 128), 3'000.0F);
    }
}

TEST(Cvfh, ARoughPieceGetsOneRow) {
    PointCloud cloud;
    Random random(2);
    for (int i = 0; i < 2'000; ++i) {
        cloud.points.push_back((10.0 * random.uniform() * random.direction()).cast<float>());
        cloud.normals.push_back(random.direction().cast<float>());
    }
    cloud.viewpoint = Vec3f(0, 0, 100);
    const auto result = describe_cvfh(cloud);
    EXPECT_TRUE(result.regions.empty());
    EXPECT_EQ(result.rows.size(), kCvfhLength);
    EXPECT_EQ(result.region_of_row, std::vector<std::uint32_t>{kNoIndex});
}

TEST(Cvfh, RigidMotionKeepsRegionsAndRows) {
    for (const PointCloud& cloud : {shapes::notched_box(4'000), shapes::cut_torus(4'000)}) {
        const auto before = describe_cvfh(cloud);
        const auto after = describe_cvfh(transformed(cloud, some_motion()));
        ASSERT_EQ(before.regions.size(), after.regions.size());
        for (std::size_t r = 0; r < before.regions.size(); ++r) {
            const Vec3f moved =
                (some_motion() * before.regions[r].centroid.cast<double>()).cast<float>();
            EXPECT_LE((moved - after.regions[r].centroid).norm(), 0.05F);
        }
        EXPECT_LE(shapes::relative_l1(after.rows, before.rows), 0.02);
    }
}

TEST(Cvfh, ThreadCountChangesNoBit) {
    const PointCloud cloud = shapes::cut_torus(5'000);
    set_thread_count(1);
    const auto one = describe_cvfh(cloud);
    set_thread_count(0);
    EXPECT_EQ(describe_cvfh(cloud).rows, one.rows);
}

TEST(Cvfh, FarawayPointsChangeNoRegion) {
    PointCloud cloud = shapes::notched_box(3'000);
    const auto radius = static_cast<float>(3.0 * mesh_resolution(cloud.points));
    const auto before = smooth_regions(cloud, {}, {.normal_radius = radius});
    for (const float far : {1e6F, 1e6F + 1.0F, -1e9F}) {
        cloud.points.push_back(Vec3f::Constant(far));
        cloud.normals.push_back(Vec3f::UnitZ());
    }
    const auto after = smooth_regions(cloud, {}, {.normal_radius = radius});
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t r = 0; r < before.size(); ++r) EXPECT_EQ(before[r].points, after[r].points);
}

}  // namespace
}  // namespace ostraka
