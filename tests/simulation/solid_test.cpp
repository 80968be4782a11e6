// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/solid.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "ostraka/base/error.hpp"
#include "ostraka/base/random.hpp"
#include "ostraka/simulation/parts.hpp"

namespace ostraka {
namespace {

Vec3d random_point(Random& random, double reach) {
    const double x = random.uniform(-reach, reach);
    const double y = random.uniform(-reach, reach);
    return {x, y, random.uniform(-reach, reach)};
}

std::vector<Solid> primitives() {
    const std::vector<Vec2d> star{{0, 0}, {5, -3}, {4, 1}, {6, 4}, {1, 3}};
    const std::vector<SweepBall> balls{{{0, 0, 0}, 2.0}, {{5, 1, 0}, 1.0}, {{6, 5, 2}, 1.5}};
    return {box({4, 6, 8}),
            rounded_box({4, 6, 8}, 1.0),
            cylinder(3.0, 5.0),
            capped_cone(4.0, 0.0, 6.0),
            capped_cone(1.0, 3.0, 4.0),
            sphere(3.0),
            torus(4.0, 1.5),
            half_space({1, 2, 2}, 3.0),
            extruded(star, 4.0),
            revolved(star),
            hexagonal_prism(5.0, 3.0),
            link(3.0, 1.0, 6.0, 2.0),
            swept(balls)};
}

TEST(Solid, DistancesOfPrimitivesMatchClosedForms) {
    EXPECT_DOUBLE_EQ(box({4, 6, 8}).distance({5, 7, 0}), 5.0);
    EXPECT_DOUBLE_EQ(box({4, 6, 8}).distance({1.5, 0, 0}), -0.5);
    EXPECT_DOUBLE_EQ(rounded_box({4, 4, 4}, 1.0).distance({2, 2, 2}), std::sqrt(3.0) - 1.0);
    EXPECT_DOUBLE_EQ(cylinder(3.0, 4.0).distance({0, 6, 6}), 5.0);
    EXPECT_NEAR(capped_cone(4.0, 0.0, 3.0).distance({0, 0, 0}), -1.5 * 0.8, 1e-12);
    EXPECT_DOUBLE_EQ(sphere(3.0).distance({0, 0, 1}), -2.0);
    EXPECT_DOUBLE_EQ(torus(4.0, 1.0).distance({0, 4, 2}), 1.0);
    EXPECT_DOUBLE_EQ(half_space({0, 0, 2}, 6.0).distance({9, 9, 5}), 2.0);
    EXPECT_DOUBLE_EQ(hexagonal_prism(6.0, 2.0).distance({5, 0, 0}), 2.0);
    EXPECT_NEAR(hexagonal_prism(6.0, 2.0).distance({0, 5, 0}), 5.0 - 6.0 / std::sqrt(3.0), 1e-12);
    EXPECT_DOUBLE_EQ(link(2.0, 2.0, 5.0, 2.0).distance({3, 5, 0}), 3.0);
    const std::vector<SweepBall> bar{{{0, 0, 0}, 1.0}, {{0, 0, 9}, 1.0}};
    EXPECT_DOUBLE_EQ(swept(bar).distance({3, 4, 5}), 4.0);
}

TEST(Solid, APolygonMayRunEitherWayAndBeConcave) {
    const std::vector<Vec2d> left{{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}};
    const std::vector<Vec2d> right(left.rbegin(), left.rend());
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        const Vec3d p = random_point(random, 6.0);
        EXPECT_NEAR(extruded(left, 2.0).distance(p), extruded(right, 2.0).distance(p), 1e-12);
    }
    EXPECT_GT(extruded(left, 2.0).distance({2, 2, 0}), 0.0);
    EXPECT_LT(extruded(left, 2.0).distance({2, 0.5, 0}), 0.0);
}

TEST(Solid, TheAxisOfATurnedOutlineIsNoSurface) {
    const std::vector<Vec2d> outline{{0, -2}, {3, -2}, {3, 2}, {0, 2}};
    EXPECT_DOUBLE_EQ(revolved(outline).distance({0, 0, 0}), -2.0);
    EXPECT_DOUBLE_EQ(revolved(outline).distance({0, 0, 3}), 1.0);
}

TEST(Solid, OperationsFollowTheLogicOfSets) {
    const Solid a = sphere(2.0);
    const Solid b = moved(box({3, 3, 3}), {1.5, 0, 0});
    Random random(1);
    for (int i = 0; i < 500; ++i) {
        const Vec3d p = random_point(random, 4.0);
        const bool in_a = a.distance(p) < 0.0;
        const bool in_b = b.distance(p) < 0.0;
        EXPECT_EQ(unite({a, b}).distance(p) < 0.0, in_a || in_b);
        EXPECT_EQ(intersect(a, b).distance(p) < 0.0, in_a && in_b);
        EXPECT_EQ(subtract(a, b).distance(p) < 0.0, in_a && !in_b);
        EXPECT_LE(smooth_unite(a, b, 1.0).distance(p), unite({a, b}).distance(p));
        EXPECT_GE(smooth_unite(a, b, 1.0).distance(p), unite({a, b}).distance(p) - 0.25);
    }
}

TEST(Solid, MotionsMoveTheSurfaceTheRightWay) {
    const Solid peg = moved(sphere(1.0), {5, 0, 0});
    EXPECT_NEAR(rotated(peg, Vec3d::UnitZ(), kPi / 2.0).distance({0, 5, 0}), -1.0, 1e-12);
    EXPECT_NEAR(rotated(peg, {0, 3, 0}, kPi / 2.0).distance({0, 0, -5}), -1.0, 1e-12);
    EXPECT_NEAR(with_mirror(peg, 0).distance({-5, 0, 0}), -1.0, 1e-12);
    EXPECT_NEAR(circular(peg, 4).distance({0, -5, 0}), -1.0, 1e-12);
    EXPECT_GT(circular(peg, 4).distance({3.5, 3.5, 0}), 0.0);
    const Bounds3 bounds = rotated(peg, Vec3d::UnitZ(), kPi / 2.0).bounds();
    EXPECT_NEAR(bounds.low.y(), 4.0, 1e-9);
    EXPECT_NEAR(bounds.high.y(), 6.0, 1e-9);
}

// Sparse contouring relies on it: see solid.hpp.
TEST(Solid, NoFieldChangesFasterThanTheWay) {
    std::vector<Solid> solids = primitives();
    for (const PartKind kind : all_parts()) solids.push_back(part_solid(kind));
    Random random(7);
    for (std::size_t s = 0; s < solids.size(); ++s) {
        for (int i = 0; i < 2000; ++i) {
            const Vec3d p = random_point(random, s < primitives().size() ? 9.0 : 60.0);
            const Vec3d q = p + random.uniform(0.0, 3.0) * random.direction();
            ASSERT_LE(std::abs(solids[s].distance(p) - solids[s].distance(q)),
                      (p - q).norm() * (1.0 + 1e-12) + 1e-12)
                << "solid " << s;
        }
    }
}

TEST(Solid, SpecializedIsBitIdenticalInTheBall) {
    Random random(9);
    for (const PartKind kind : all_parts()) {
        const Solid solid = part_solid(kind, 5);
        for (int i = 0; i < 40; ++i) {
            const Vec3d center = random_point(random, 50.0);
            const double radius = random.uniform(0.5, 20.0);
            const Solid local = solid.specialized(center, radius);
            for (int j = 0; j < 20; ++j) {
                const Vec3d p = center + radius * random.uniform() * random.direction();
                ASSERT_EQ(local.distance(p), solid.distance(p)) << part_name(kind);
            }
        }
    }
}

TEST(Solid, BoundsContainTheSolid) {
    Random random(11);
    for (const Solid& solid : primitives()) {
        for (int i = 0; i < 2000; ++i) {
            const Vec3d p = random_point(random, 9.0);
            if (solid.distance(p) >= 0.0) continue;
            EXPECT_GE((p - solid.bounds().low).minCoeff(), 0.0);
            EXPECT_GE((solid.bounds().high - p).minCoeff(), 0.0);
        }
    }
}

TEST(Solid, RejectsImpossibleSizes) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(box({1, 0, 1}), InvalidInput);
    EXPECT_THROW(sphere(nan), InvalidInput);
    EXPECT_THROW(rounded_box({1, 1, 1}, 0.5), InvalidInput);
    EXPECT_THROW(torus(1.0, 1.0), InvalidInput);
    EXPECT_THROW(link(3.0, 1.0, 2.0, 1.0), InvalidInput);
    EXPECT_THROW(capped_cone(0.0, 0.0, 1.0), InvalidInput);
    EXPECT_THROW(extruded(std::vector<Vec2d>{{0, 0}, {1, 0}}, 1.0), InvalidInput);
    EXPECT_THROW(revolved(std::vector<Vec2d>{{-1, 0}, {1, 0}, {1, 1}}), InvalidInput);
    EXPECT_THROW(unite(std::vector<Solid>{}), InvalidInput);
    EXPECT_THROW(circular(sphere(1.0), 0), InvalidInput);
    EXPECT_THROW(with_mirror(sphere(1.0), 3), InvalidInput);
}

}  // namespace
}  // namespace ostraka
