// SPDX-License-Identifier: Apache-2.0
#include "ostraka/segmentation/convex_parts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"
#include "segmentation/depth_scans.hpp"
#include "segmentation/partitions.hpp"

namespace ostraka {
namespace {

using test_scans::ball;
using test_scans::best_agreement;
using test_scans::box;
using test_scans::cylinder;
using test_scans::scan;
using test_scans::table;

const PatchSettings kUnit{.sampling = 1.0};
const Vec3d kEye(120, 140, 180);

// Every solid is one part, to a share of its points, whatever the noise.
void expect_apart(const std::vector<test_scans::Solid>& solids, const Vec3d& eye, double least) {
    for (const double noise : {0.0, 0.1, 0.2}) {
        const test_scans::Scan seen = scan(solids, eye, noise);
        ASSERT_EQ(euclidean_clusters(seen.cloud.points, 2.0, 60).size(), 1U) << "they touch";
        const ConvexParts parts = convex_parts(seen.cloud, kUnit);
        EXPECT_EQ(parts.parts.size(), solids.size()) << "noise " << noise;
        for (std::uint32_t s = 0; s < solids.size(); ++s) {
            EXPECT_GT(best_agreement(seen, s, parts.parts), least) << s << " noise " << noise;
        }
    }
}

TEST(ConvexParts, SeparateABoxFromTheBoxBelow) {
    expect_apart({box({15, 12, 8}, {0, 0, 8}, 0.3), box({8, 8, 8}, {1, 0, 24}, 0.8)}, kEye, 0.9);
}

TEST(ConvexParts, SeparateABoxFromTheTable) {
    expect_apart({table(45), box({15, 12, 8}, {0, 0, 8}, 0.3)}, kEye, 0.9);
}

TEST(ConvexParts, SeparateABallFromTheBoxBelow) {
    // From low enough that the contact is in view.
    expect_apart({box({20, 15, 8}, {0, 0, 0}, 0.2), ball(10, {4, 4, 17})}, {150, 160, 60}, 0.9);
}

TEST(ConvexParts, SeparateBoxesSideBySide) {
    expect_apart({box({10, 15, 8}, {-10, 0, 8}), box({10, 12, 14}, {10, 0, 14})}, {-120, 140, 180},
                 0.9);
}

TEST(ConvexParts, SeparateCylindersSideBySide) {
    expect_apart({cylinder(8, 25, {0, -8, 8}, true), cylinder(8, 25, {0, 8, 8}, true)},
                 {20, 30, 250}, 0.9);
}

TEST(ConvexParts, SeparateACylinderFromTheTable) {
    expect_apart({table(45), cylinder(10, 12, {0, 0, 12})}, kEye, 0.9);
    expect_apart({table(45), cylinder(8, 20, {0, 0, 8}, true)}, kEye, 0.9);
}

TEST(ConvexParts, KeepConvexThingsWhole) {
    const std::vector<test_scans::Solid> solids = {box({20, 12, 8}, {0, 0, 0}, 0.3),
                                                   box({30, 4, 4}, {0, 0, 0}, 0.5),
                                                   ball(8, {0, 0, 0}),
                                                   ball(15, {0, 0, 0}),
                                                   ball(40, {0, 0, 0}),
                                                   cylinder(10, 15, {0, 0, 0}),
                                                   cylinder(6, 25, {0, 0, 0}, true)};
    for (std::size_t s = 0; s < solids.size(); ++s) {
        for (const double noise : {0.0, 0.1, 0.2}) {
            const test_scans::Scan seen = scan({solids[s]}, kEye, noise);
            const ConvexParts parts = convex_parts(seen.cloud, kUnit);
            ASSERT_EQ(parts.parts.size(), 1U) << "solid " << s << " noise " << noise;
            EXPECT_GT(parts.parts[0].size(), seen.cloud.size() * 98 / 100) << s;
            EXPECT_TRUE(parts.contacts.empty());
        }
    }
}

TEST(ConvexParts, TurnWithTheCloud) {
    test_scans::Scan seen =
        scan({box({15, 12, 8}, {0, 0, 8}, 0.3), box({8, 8, 8}, {1, 0, 24}, 0.8)}, kEye, 0.2);
    const PointCloud cloud = seen.cloud;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        seen.cloud = transformed(cloud, test_clouds::random_pose(seed, 300.0));
        const ConvexParts parts = convex_parts(seen.cloud, kUnit);
        EXPECT_LE(parts.parts.size(), 3U)
            << "patches start on a grid that doesn't turn: no exact copy";
        for (std::uint32_t s = 0; s < 2; ++s) {
            EXPECT_GT(best_agreement(seen, s, parts.parts), 0.85) << seed;
        }
    }
}

TEST(ConvexParts, DoNotDependOnTheOrderOfPoints) {
    const PointCloud cloud = scan({table(40), box({10, 8, 8}, {0, 0, 8}, 0.5)}, kEye, 0.2).cloud;
    const ConvexParts parts = convex_parts(cloud, kUnit);
    ASSERT_EQ(parts.parts.size(), 2U);
    ASSERT_EQ(parts.contacts.size(), 1U);
    EXPECT_GT(parts.contacts[0].concave, parts.contacts[0].pairs / 2);
    const std::vector<std::uint32_t> order = test_scans::shuffled(cloud.size(), 8);
    const ConvexParts others = convex_parts(select(cloud, order), kUnit);
    EXPECT_EQ(test_scans::in_original(others.parts, order),
              test_scans::in_original(parts.parts, test_scans::all_of(cloud.size())));
    ASSERT_EQ(others.contacts.size(), 1U);
    EXPECT_EQ(others.contacts[0].pairs, parts.contacts[0].pairs);
}

// Patches 4 apart along x, on a floor (y < 0) and a slope (y > 0) that rises by `rise` from y = 0.
// One of the slope's patches has a normal in between.
SurfacePatches floor_and_slope(double rise) {
    SurfacePatches surface;
    const auto add = [&](const Vec3d& center, double tilt) {
        SurfacePatch patch;
        patch.center = center;
        patch.normal = Vec3d(0, -std::sin(tilt), std::cos(tilt));
        for (int i = 0; i < 16; ++i) {
            patch.indices.push_back(static_cast<std::uint32_t>(surface.patch_of.size()));
            surface.patch_of.push_back(static_cast<std::uint32_t>(surface.patches.size()));
        }
        surface.patches.push_back(patch);
    };
    for (int i = 0; i < 7; ++i) add({4.0 * i, -2, 0}, 0.0);
    for (int i = 0; i < 7; ++i) {
        add({4.0 * i, 2 * std::cos(rise), 2 * std::sin(rise)}, i == 3 ? 0.5 * rise : rise);
    }
    for (std::uint32_t i = 0; i < 7; ++i) {
        const auto touch = [&](std::uint32_t a, std::uint32_t b) {
            surface.contacts.push_back(
                {a, b, 10, 0.5 * (surface.patches[a].center + surface.patches[b].center)});
        };
        touch(i, i + 7);
        if (i == 6) continue;
        touch(i, i + 1);
        touch(i + 7, i + 8);
    }
    return surface;
}

TEST(ConvexParts, OneWrongEdgeDoesNotJoinWhatARowOfConcaveOnesSeparates) {
    const SurfacePatches surface = floor_and_slope(0.3);
    EXPECT_EQ(convex_parts(surface, 1.0, {.max_share = 1.0}).parts.size(), 1U) << "it would";
    const ConvexParts parts = convex_parts(surface, 1.0);
    ASSERT_EQ(parts.parts.size(), 2U);
    EXPECT_GE(parts.parts[1].size(), 6U * 16U);
    EXPECT_EQ(convex_parts(floor_and_slope(-0.3), 1.0).parts.size(), 1U) << "a roof is convex";
    EXPECT_EQ(convex_parts(floor_and_slope(0.15), 1.0).parts.size(), 1U) << "a shallow dent";
}

SurfacePatch patch_at(const Vec3d& center, const Vec3d& normal) {
    SurfacePatch patch;
    patch.center = center;
    patch.normal = normal.normalized();
    return patch;
}

TEST(BendBetween, TellsRoofFromDitchAndStepAndCorner) {
    const auto bend = [](const SurfacePatch& a, const SurfacePatch& b) {
        const PatchContact contact{0, 1, 10, 0.5 * (a.center + b.center)};
        const Bend one = bend_between(a, b, contact, 1.0, {});
        EXPECT_EQ(one, bend_between(b, a, contact, 1.0, {})) << "the same from either side";
        return one;
    };
    const SurfacePatch left = patch_at({-2, 0, 0}, {-1, 0, 1});
    EXPECT_EQ(bend(left, patch_at({2, 0, 0}, {1, 0, 1})), Bend::convex);
    EXPECT_EQ(bend(patch_at({-2, 0, 0}, {1, 0, 1}), patch_at({2, 0, 0}, {-1, 0, 1})),
              Bend::concave);
    const SurfacePatch flat = patch_at({-2, 0, 0}, {0, 0, 1});
    EXPECT_EQ(bend(flat, patch_at({2, 0, 0}, {0, 0, 1})), Bend::convex) << "straight on";
    EXPECT_EQ(bend(flat, patch_at({2, 0, 0}, {-0.1, 0, 1})), Bend::convex) << "within tolerance";
    EXPECT_EQ(bend(flat, patch_at({2, 0, 0}, {-0.3, 0, 1})), Bend::concave);
    EXPECT_EQ(bend(flat, patch_at({2, 0, 1.5}, {0, 0, 1})), Bend::step);
    EXPECT_EQ(bend(flat, patch_at({2, 0, 0.5}, {0, 0, 1})), Bend::convex) << "noise";
    EXPECT_EQ(bend(left, patch_at({-2 + 0.5, 4, 0}, {1, 0, 1})), Bend::singular)
        << "beside each other along the crease";
    // Two patches of a ball of radius 6: as far below their middle from either.
    const double t = 0.3;
    EXPECT_EQ(bend(patch_at({-6 * std::sin(t), 0, 6 * std::cos(t)}, {-std::sin(t), 0, std::cos(t)}),
                   patch_at({6 * std::sin(t), 0, 6 * std::cos(t)}, {std::sin(t), 0, std::cos(t)})),
              Bend::convex);
}

TEST(ConvexParts, SmallPartsJoinTheirNeighborOrAreLeftOut) {
    const test_scans::Scan seen =
        scan({table(30), box({3, 3, 3}, {0, 0, 3}, 0.3)}, {60, 70, 250}, 0.1);
    const ConvexParts fine = convex_parts(seen.cloud, kUnit, {.min_points = 20});
    ASSERT_EQ(fine.parts.size(), 2U);
    const ConvexParts coarse =
        convex_parts(seen.cloud, kUnit, {.min_points = fine.parts[1].size() + 1});
    ASSERT_EQ(coarse.parts.size(), 1U);
    EXPECT_EQ(coarse.parts[0].size(), fine.parts[0].size() + fine.parts[1].size());
    EXPECT_TRUE(
        convex_parts(seen.cloud, kUnit, {.min_points = seen.cloud.size() + 1}).parts.empty());
}

TEST(ConvexParts, TakeEmptyInvalidAndSinglePoints) {
    EXPECT_TRUE(convex_parts(PointCloud{}, kUnit).parts.empty());
    PointCloud cloud;
    cloud.points = {{1, 2, 3}};
    cloud.normals = {{0, 0, 1}};
    EXPECT_TRUE(convex_parts(cloud, kUnit).parts.empty()) << "less than 60 points";
    EXPECT_EQ(convex_parts(cloud, kUnit, {.min_points = 1}).parts.size(), 1U);
    cloud.points.push_back(test_clouds::nowhere());
    cloud.normals.push_back({0, 0, 1});
    const ConvexParts parts = convex_parts(cloud, kUnit, {.min_points = 1});
    EXPECT_EQ(parts.parts, (Clusters{{0}}));
    EXPECT_THROW(convex_parts(cloud, PatchSettings{}), InvalidInput) << "no sampling";
    cloud.normals.clear();
    EXPECT_THROW(convex_parts(cloud, kUnit), InvalidInput);
}

}  // namespace
}  // namespace ostraka
