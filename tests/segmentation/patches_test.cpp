// SPDX-License-Identifier: Apache-2.0
#include "ostraka/segmentation/patches.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "ostraka/base/error.hpp"
#include "segmentation/depth_scans.hpp"
#include "segmentation/partitions.hpp"

namespace ostraka {
namespace {

const PatchSettings kUnit{.sampling = 1.0};

PointCloud box_cloud(double noise = 0.2) {
    return test_scans::scan({test_scans::box({20, 12, 8}, {0, 0, 0}, 0.3)}, {120, 140, 180}, noise)
        .cloud;
}

TEST(SurfacePatches, CutACloudIntoConnectedPiecesOfTheGivenSize) {
    const PointCloud cloud = box_cloud();
    const SurfacePatches surface = surface_patches(cloud, kUnit);
    std::vector<int> times(cloud.size(), 0);
    for (std::uint32_t p = 0; p < surface.patches.size(); ++p) {
        const SurfacePatch& patch = surface.patches[p];
        ASSERT_TRUE(std::is_sorted(patch.indices.begin(), patch.indices.end()));
        for (const std::uint32_t i : patch.indices) {
            ++times[i];
            EXPECT_EQ(surface.patch_of[i], p);
            EXPECT_LT((cloud.points[i].cast<double>() - patch.center).norm(), 8.0);
        }
        EXPECT_EQ(largest_group(surface.graph, patch.indices), patch.indices) << "connected";
        EXPECT_NEAR(patch.normal.norm(), 1.0, 1e-9);
    }
    EXPECT_TRUE(std::all_of(times.begin(), times.end(), [](int n) { return n == 1; }));
    const double mean =
        static_cast<double>(cloud.size()) / static_cast<double>(surface.patches.size());
    EXPECT_GT(mean, 8.0);
    EXPECT_LT(mean, 20.0) << "16 points on 4 x 4 sampling distances";
}

TEST(SurfacePatches, DoNotCrossACrease) {
    const PointCloud cloud = box_cloud(0.0);
    const SurfacePatches surface = surface_patches(cloud, kUnit);
    // The rows beside an edge have blended normals; all else must not be mixed.
    std::size_t mixed = 0;
    for (const SurfacePatch& patch : surface.patches) {
        for (const std::uint32_t i : patch.indices) {
            const bool pure = cloud.normals[i].cwiseAbs().z() > 0.999F ||
                              cloud.normals[i].cwiseAbs().z() < 0.001F;
            if (pure && patch.normal.dot(cloud.normals[i].cast<double>()) < 0.7) ++mixed;
        }
    }
    EXPECT_LT(mixed, cloud.size() / 200);
}

TEST(SurfacePatches, ContactsAreThoseOfTheGraph) {
    const PointCloud cloud = box_cloud();
    const SurfacePatches surface = surface_patches(cloud, kUnit);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> expected;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        for (std::uint32_t j = 0; j < cloud.size(); ++j) {
            if ((cloud.points[i] - cloud.points[j]).norm() >= 2.0F) continue;
            const auto [a, b] = std::pair(surface.patch_of[i], surface.patch_of[j]);
            if (a < b) ++expected[{a, b}];
        }
    }
    EXPECT_EQ(surface.contacts.size(), expected.size());
    for (const PatchContact& contact : surface.contacts) {
        EXPECT_EQ(contact.pairs, (expected[{contact.a, contact.b}]));
        EXPECT_LT((contact.middle - surface.patches[contact.a].center).norm(), 8.0);
    }
}

TEST(SurfacePatches, InSpatialOrderDoNotDependOnTheOrderOfPoints) {
    const PointCloud cloud = box_cloud();
    const std::vector<std::uint32_t> order = test_scans::shuffled(cloud.size(), 3);
    const PointCloud other = select(cloud, order);
    const auto first = select(cloud, spatial_order(cloud, 1.0));
    const auto second = select(other, spatial_order(other, 1.0));
    ASSERT_EQ(first.points, second.points);
    EXPECT_NE(cloud.points, other.points);
    EXPECT_EQ(surface_patches(first, kUnit).patch_of, surface_patches(second, kUnit).patch_of);
}

TEST(SpatialOrder, LeavesOutWhatIsNotFinite) {
    PointCloud cloud = box_cloud();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    cloud.points[3].y() = nan;
    cloud.normals[5].x() = nan;
    std::vector<std::uint32_t> order = spatial_order(cloud, 1.0);
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> expected = test_scans::all_of(cloud.size());
    expected.erase(expected.begin() + 5);
    expected.erase(expected.begin() + 3);
    EXPECT_EQ(order, expected);
    const std::vector<std::uint32_t> beyond = {static_cast<std::uint32_t>(cloud.size())};
    EXPECT_THROW(spatial_order(cloud, beyond, 1.0), InvalidInput);
    EXPECT_THROW(spatial_order(cloud, 0.0), InvalidInput);
}

TEST(SurfacePatches, OfLittleAreLittle) {
    EXPECT_TRUE(surface_patches({}, kUnit).patches.empty());
    PointCloud one;
    one.points = {{1, 2, 3}};
    one.normals = {{0, 0, 1}};
    const SurfacePatches surface = surface_patches(one, kUnit);
    ASSERT_EQ(surface.patches.size(), 1U);
    EXPECT_EQ(surface.patches[0].center, Vec3d(1, 2, 3));
    EXPECT_TRUE(surface.contacts.empty());
    EXPECT_THROW(surface_patches(one, {}), InvalidInput) << "no sampling";
    one.normals.clear();
    EXPECT_THROW(surface_patches(one, kUnit), InvalidInput);
}

}  // namespace
}  // namespace ostraka
