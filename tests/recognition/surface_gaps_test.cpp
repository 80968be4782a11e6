// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/surface_gaps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

constexpr double kEye = 800.0;     // height of the sensor above the plane z = 0
constexpr double kPitch = 1.0;     // of its rays, where they meet the plane
constexpr double kSlack = 1.0;     // of the plane
constexpr double kNoise = 0.4;     // deviation
constexpr double kBehind = -40.0;  // height of what is seen through gaps
constexpr double kFront = 30.0;

// The height at which the ray toward a place on the plane ends; none: nothing is measured.
using Scene = std::function<std::optional<double>(double x, double y)>;

PointCloud scan_of(const Scene& scene) {
    Random random(1);
    PointCloud scan;
    scan.viewpoint = Vec3f(0.0F, 0.0F, static_cast<float>(kEye));
    for (double y = -80.0; y <= 80.0; y += kPitch) {
        for (double x = -80.0; x <= 80.0; x += kPitch) {
            const std::optional<double> height = scene(x, y);
            if (!height) continue;
            const double z = *height + kNoise * random.normal();
            const double t = (kEye - z) / kEye;
            scan.points.push_back(Vec3d(t * x, t * y, z).cast<float>());
        }
    }
    return scan;
}

// The square around the origin with sides of 120.
std::vector<PlanePiece> parts_of(const Scene& scene) {
    PlanePiece piece;
    piece.extents = Vec2d(120.0, 120.0);
    piece.indices = {1, 2, 3};
    return part_at_gaps(piece, scan_of(scene), kPitch, kSlack);
}

bool inside(double x, double y) {
    return std::abs(x) < 60.0 && std::abs(y) < 60.0;
}

TEST(SurfaceGaps, AClosedSurfaceStaysWhole) {
    const auto parts = parts_of([](double x, double y) { return inside(x, y) ? 0.0 : kBehind; });
    ASSERT_EQ(parts.size(), 1U);
    EXPECT_EQ(parts[0].indices.size(), 3U);
    EXPECT_EQ(parts[0].extents, Vec2d(120.0, 120.0));
}

TEST(SurfaceGaps, WhatIsSeenThroughOneParts) {
    const auto parts = parts_of([](double x, double y) {
        return inside(x, y) && std::abs(x - 20.0) > 2.5 ? 0.0 : kBehind;
    });
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_NEAR(parts[0].extents.x(), 77.5, 3.0);
    EXPECT_NEAR(parts[0].extents.y(), 120.0, 3.0);
    EXPECT_NEAR(parts[0].T_cloud_piece.translation().x(), -21.25, 2.0);
    EXPECT_NEAR(parts[1].extents.x(), 37.5, 3.0);
    EXPECT_NEAR(parts[1].T_cloud_piece.translation().x(), 41.25, 2.0);
}

TEST(SurfaceGaps, WhereNothingIsMeasuredParts) {
    const auto parts = parts_of([](double x, double y) -> std::optional<double> {
        if (std::abs(y + x) < 4.0) return std::nullopt;
        return inside(x, y) ? 0.0 : kBehind;
    });
    EXPECT_EQ(parts.size(), 2U);
}

TEST(SurfaceGaps, CrossedGapsMakeFourParts) {
    const auto parts = parts_of([](double x, double y) {
        return inside(x, y) && std::abs(x) > 2.5 && std::abs(y) > 2.5 ? 0.0 : kBehind;
    });
    ASSERT_EQ(parts.size(), 4U);
    for (const PlanePiece& part : parts) EXPECT_NEAR(part.extents.maxCoeff(), 57.5, 3.0);
}

TEST(SurfaceGaps, WhatIsInFrontPartsNothing) {
    const auto parts = parts_of([](double x, double y) {
        if (std::abs(x) < 15.0) return kFront;
        return inside(x, y) ? 0.0 : kBehind;
    });
    EXPECT_EQ(parts.size(), 1U);
}

TEST(SurfaceGaps, ASlotPartsNothing) {
    const auto parts = parts_of([](double x, double y) {
        const bool slot = std::abs(x) < 2.5 && y < 40.0;
        return inside(x, y) && !slot ? 0.0 : kBehind;
    });
    EXPECT_EQ(parts.size(), 1U);
}

TEST(SurfaceGaps, WithoutAPitchNothingIsKnown) {
    PlanePiece piece;
    piece.extents = Vec2d(120.0, 120.0);
    const PointCloud scan =
        scan_of([](double x, double) { return std::abs(x) < 10.0 ? kBehind : 0.0; });
    EXPECT_EQ(part_at_gaps(piece, scan, 0.0, kSlack).size(), 1U);
    EXPECT_EQ(part_at_gaps(piece, scan, kPitch, kSlack).size(), 2U);
}

}  // namespace
}  // namespace ostraka
