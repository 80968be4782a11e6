// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/surface_extents.hpp"

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
constexpr double kNoise = 0.3;     // deviation
constexpr double kBehind = -40.0;  // height of what is seen through gaps
constexpr double kFront = 30.0;
constexpr double kCell = 1.5 * kPitch;

// The height at which the ray toward a place on the plane ends; none: nothing is measured.
using Scene = std::function<std::optional<double>(double x, double y)>;

// Of the rectangle of 120 by 60 around the origin.
SurfaceExtents extents_of(const Scene& scene) {
    Random random(1);
    PointCloud scan;
    scan.viewpoint = Vec3f(0.0F, 0.0F, static_cast<float>(kEye));
    for (double y = -60.0; y <= 60.0; y += kPitch) {
        for (double x = -80.0; x <= 80.0; x += kPitch) {
            const std::optional<double> height = scene(x, y);
            if (!height) continue;
            const double z = *height + kNoise * random.normal();
            const double t = (kEye - z) / kEye;
            scan.points.push_back(Vec3d(t * x, t * y, z).cast<float>());
        }
    }
    PlanePiece piece;
    piece.extents = Vec2d(120.0, 60.0);
    return SurfaceExtents(piece, scan, kPitch, kSlack);
}

bool inside(double x, double y) {
    return std::abs(x) < 60.0 && std::abs(y) < 30.0;
}

TEST(SurfaceExtents, OfARectangleBetweenItsSideAndItsDiagonal) {
    const auto extents =
        extents_of([](double x, double y) { return inside(x, y) ? 0.0 : kBehind; });
    for (const Vec3d& place : {Vec3d(0, 0, 0), Vec3d(55, 25, 0), Vec3d(-58, 0, 0.5)}) {
        EXPECT_GT(extents.at(place), 120.0 - 2.0 * kCell);
        EXPECT_LT(extents.at(place), std::hypot(120.0, 60.0) + 2.0 * kCell);
    }
    EXPECT_EQ(extents.at(Vec3d(70, 0, 0)), 0.0);
    EXPECT_EQ(extents.at(Vec3d(0, -1e9, 0)), 0.0);
}

TEST(SurfaceExtents, EndWhereRaysGoThrough) {
    const auto extents = extents_of([](double x, double y) {
        return inside(x, y) && std::abs(x - 20.0) > 2.0 ? 0.0 : kBehind;
    });
    EXPECT_GT(extents.at(Vec3d(-20, 0, 0)), 78.0 - 2.0 * kCell);
    EXPECT_LT(extents.at(Vec3d(-20, 0, 0)), std::hypot(78.0, 60.0) + 2.0 * kCell);
    EXPECT_GT(extents.at(Vec3d(40, 0, 0)), 60.0 - 2.0 * kCell);
    EXPECT_LT(extents.at(Vec3d(40, 0, 0)), std::hypot(38.0, 60.0) + 2.0 * kCell);
}

TEST(SurfaceExtents, EndWhereNothingIsMeasured) {
    const auto extents = extents_of([](double x, double y) -> std::optional<double> {
        if (std::abs(x) < 2.0) return std::nullopt;
        return inside(x, y) ? 0.0 : kBehind;
    });
    EXPECT_LT(extents.at(Vec3d(-30, 0, 0)), std::hypot(58.0, 60.0) + 2.0 * kCell);
}

TEST(SurfaceExtents, GoOnBehindWhatIsInFrontButNotBeyondTheSurface) {
    const auto strip = [](double first, double last) {
        return extents_of([=](double x, double y) {
            if (x > first && x < last) return kFront;
            return inside(x, y) && std::abs(y) < 10.0 ? 0.0 : kBehind;
        });
    };
    EXPECT_GT(strip(-15.0, 15.0).at(Vec3d(-40, 0, 0)), 120.0 - 2.0 * kCell);
    EXPECT_LT(strip(20.0, 70.0).at(Vec3d(-40, 0, 0)), std::hypot(80.0, 20.0) + 2.0 * kCell);
}

TEST(SurfaceExtents, SinglePixelsThatAreMissingDontMatter) {
    Random random(2);
    const auto extents = extents_of([&](double x, double y) -> std::optional<double> {
        if (random.uniform(0.0, 1.0) < 0.05) return std::nullopt;
        return inside(x, y) ? 0.0 : kBehind;
    });
    EXPECT_GT(extents.at(Vec3d(0, 0, 0)), 110.0);
}

// Two brims side by side: only the few lines through where they touch get far on both.
TEST(SurfaceExtents, OfRingsThatTouchAreMostlyThoseOfOne) {
    const auto extents = extents_of([](double x, double y) {
        const double r = std::hypot(std::abs(x) - 29.5, y);
        return r > 20.0 && r < 30.0 ? 0.0 : kBehind;
    });
    const double chord = 2.0 * std::sqrt(30.0 * 30.0 - 20.0 * 20.0);
    int longer = 0;
    for (int i = 0; i < 36; ++i) {
        const double angle = 2.0 * kPi * i / 36.0;
        const Vec3d place(29.5 + 25.0 * std::cos(angle), 25.0 * std::sin(angle), 0.0);
        EXPECT_GT(extents.at(place), 0.8 * chord);
        if (extents.at(place) > 1.2 * chord) ++longer;
    }
    EXPECT_LT(longer, 24);
}

}  // namespace
}  // namespace ostraka
