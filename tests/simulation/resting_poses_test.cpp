// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/resting_poses.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/random.hpp"
#include "ostraka/simulation/contour.hpp"
#include "ostraka/simulation/parts.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

TriangleMesh box_mesh(const Vec3f& size) {
    TriangleMesh mesh;
    testing::add_box(mesh, -size / 2.0F, size / 2.0F);
    return mesh;
}

// A cone on z = 0 with its apex at `height`; its base is a polygon.
TriangleMesh cone_mesh(float radius, float height, std::uint32_t sides) {
    TriangleMesh mesh;
    mesh.vertices = {Vec3f(0, 0, height), Vec3f(0, 0, 0)};
    for (std::uint32_t k = 0; k < sides; ++k) {
        const double angle = 2.0 * kPi * k / sides;
        mesh.vertices.push_back(
            Vec3d(radius * std::cos(angle), radius * std::sin(angle), 0.0).cast<float>());
        const std::uint32_t next = 2 + (k + 1) % sides;
        mesh.triangles.push_back({0, 2 + k, next});
        mesh.triangles.push_back({1, next, 2 + k});
    }
    return mesh;
}

// Points spread over a sphere, as a mesh: an octahedron, each face divided `levels` times in four.
TriangleMesh sphere_mesh(double radius, int levels) {
    TriangleMesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {-1.0F, 1.0F}) {
            Vec3f corner = Vec3f::Zero();
            corner[axis] = sign;
            mesh.vertices.push_back(corner);
        }
    }
    mesh.triangles = {{1, 3, 5}, {3, 0, 5}, {0, 2, 5}, {2, 1, 5},
                      {3, 1, 4}, {0, 3, 4}, {2, 0, 4}, {1, 2, 4}};
    for (int level = 0; level < levels; ++level) {
        std::vector<Triangle> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
            for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, a}}) {
                mesh.vertices.push_back((mesh.vertices[p] + mesh.vertices[q]).normalized());
            }
            finer.push_back({a, first, first + 2});
            finer.push_back({b, first + 1, first});
            finer.push_back({c, first + 2, first + 1});
            finer.push_back({first, first + 1, first + 2});
        }
        mesh.triangles = std::move(finer);
    }
    return scaled(std::move(mesh), radius);
}

double lowest_vertex(const TriangleMesh& mesh, const Mat3d& R) {
    double lowest = 1e300;
    for (const Vec3f& v : mesh.vertices) lowest = std::min(lowest, (R * v.cast<double>()).z());
    return lowest;
}

TEST(RollingShape, OfABoxIsItsCornersAndItsMiddle) {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(10, 20, 30), Vec3f(12, 26, 40));
    const RollingShape shape = rolling_shape(mesh);
    EXPECT_EQ(shape.points.size(), 8U);
    EXPECT_NEAR((shape.center_of_mass - Vec3d(11, 23, 35)).norm(), 0.0, 1e-9);
    EXPECT_NEAR(shape.radius, Vec3d(1, 3, 5).norm(), 1e-6);
}

TEST(RollingShape, CenterOfMassIsTheVolumesIfClosedElseTheSurfaces) {
    const TriangleMesh cone = cone_mesh(40.0F, 100.0F, 300);
    EXPECT_NEAR(rolling_shape(cone).center_of_mass.z(), 25.0, 0.01);
    TriangleMesh open = cone;  // without its base: an area's center is at a third of the height
    std::erase_if(open.triangles, [](const Triangle& t) { return t[0] == 1; });
    EXPECT_NEAR(rolling_shape(open).center_of_mass.z(), 100.0 / 3.0, 0.01);
}

TEST(RollToRest, ABoxRestsOnTheFaceThatTheVerticalThroughItsCenterMeets) {
    // Rolled on a corner and then on an edge, a box never crosses from one face's share of
    // directions, as seen from its center, to another's.
    const Vec3d size(10.0, 20.0, 30.0);
    const RollingShape shape = rolling_shape(box_mesh(size.cast<float>()));
    Random random(5);
    constexpr int kDrops = 20'000;
    std::array<int, 3> rests{};
    for (int i = 0; i < kDrops; ++i) {
        const Mat3d R = random.rotation();
        int expected = 0;
        R.row(2).transpose().cwiseAbs().cwiseQuotient(size).maxCoeff(&expected);
        const RestingPose pose = roll_to_rest(shape, R);
        ASSERT_TRUE(pose.at_rest);
        int face = 0;
        ASSERT_NEAR(pose.R_world_model.row(2).cwiseAbs().maxCoeff(&face), 1.0, 1e-9);
        ASSERT_EQ(face, expected);
        ASSERT_NEAR(pose.height, size[face] / 2.0, 1e-6);
        ASSERT_NEAR(
            (pose.R_world_model.transpose() * pose.R_world_model - Mat3d::Identity()).norm(), 0.0,
            1e-9);
        ++rests[static_cast<std::size_t>(face)];
    }
    // So each face's share is its solid angle: 4 atan(a b / (c d)), a, b, c half sizes, d diagonal.
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3d half = size / 2.0;
        const double c = half[axis];
        const double solid_angle = 4.0 * std::atan(half.prod() / c / (c * half.norm()));
        const double share = 2.0 * solid_angle / (4.0 * kPi);
        const double deviation = std::sqrt(share * (1.0 - share) / kDrops);
        EXPECT_NEAR(double(rests[static_cast<std::size_t>(axis)]) / kDrops, share, 4.0 * deviation);
    }
    EXPECT_GT(rests[0], rests[1]);
    EXPECT_GT(rests[1], rests[2]);
}

TEST(RollToRest, AConeRestsOnItsBaseOrItsSide) {
    const TriangleMesh mesh = cone_mesh(40.0F, 100.0F, 64);
    const RollingShape shape = rolling_shape(mesh);
    // The center of mass, at a quarter of the height, above the base and above the side.
    const double on_side = 0.75 * 100.0 * 40.0 / std::hypot(100.0, 40.0);
    Random random(6);
    int base = 0;
    for (int i = 0; i < 500; ++i) {
        const RestingPose pose = roll_to_rest(shape, random.rotation());
        ASSERT_TRUE(pose.at_rest);
        const double up = pose.R_world_model(2, 2);
        if (up > 0.999) {
            ++base;
            EXPECT_NEAR(pose.height, 25.0, 0.01);
        } else {
            EXPECT_NEAR(pose.height, on_side, 0.1);
            EXPECT_NEAR(up, -40.0 / std::hypot(100.0, 40.0), 0.01);
        }
    }
    EXPECT_GT(base, 50);
    EXPECT_LT(base, 450);
}

TEST(RollToRest, ASphereComesToRest) {
    const RollingShape shape = rolling_shape(sphere_mesh(100.0, 5));
    Random random(7);
    for (int i = 0; i < 200; ++i) {
        const RestingPose pose = roll_to_rest(shape, random.rotation());
        EXPECT_TRUE(pose.at_rest);
        EXPECT_NEAR(pose.height, 100.0, 0.5);
    }
}

TEST(RollToRest, TheCenterOfMassNeverRisesAndEndsAboveThePlane) {
    Random random(8);
    for (const PartKind kind : {PartKind::hook, PartKind::gear, PartKind::crank, PartKind::knob}) {
        const TriangleMesh mesh = make_part(kind, {.resolution = 64});
        const RollingShape shape = rolling_shape(mesh);
        for (int i = 0; i < 20; ++i) {
            const Mat3d R = random.rotation();
            const RestingPose end = roll_to_rest(shape, R);
            ASSERT_TRUE(end.at_rest);
            double before = 1e300;
            for (int rolls = 0; rolls <= end.rolls; ++rolls) {
                const double height = roll_to_rest(shape, R, rolls).height;
                ASSERT_LE(height, before + 1e-9);
                before = height;
            }
            EXPECT_EQ(before, end.height);
            // It stands on all of the mesh, not only on the points known beforehand.
            const double lowest = lowest_vertex(mesh, end.R_world_model);
            const double center = (end.R_world_model * shape.center_of_mass).z();
            EXPECT_NEAR(center - lowest, end.height, 1e-5 * shape.radius);
        }
    }
}

TEST(RollToRest, StaysWhereItRests) {
    const RollingShape shape = rolling_shape(testing::plate_model());
    Random random(9);
    for (int i = 0; i < 50; ++i) {
        const RestingPose pose = roll_to_rest(shape, random.rotation());
        const RestingPose again = roll_to_rest(shape, pose.R_world_model);
        EXPECT_LE(again.rolls, 1);
        EXPECT_NEAR((again.R_world_model - pose.R_world_model).norm(), 0.0, 1e-5);
    }
}

}  // namespace
}  // namespace ostraka
