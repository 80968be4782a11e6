// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/symmetry.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "mesh/symmetry_shapes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/mesh/surface_samples.hpp"
#include "ostraka/mesh/symmetry_poses.hpp"

namespace ostraka {
namespace {

using namespace test_meshes;

// A cylinder around z, from z = -1.5 to 1.5, with a groove of rectangular section along +x.
TriangleMesh keyed_cylinder(double depth, double low = -1.5, double high = 1.5) {
    const auto radius = [=](double angle) {
        return std::abs(std::sin(angle)) < 0.15 && std::cos(angle) > 0.0 ? 1.0 - depth : 1.0;
    };
    return extruded(curve(720, radius), low, high);
}

TriangleMesh turned_inside_out(TriangleMesh mesh) {
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
    return mesh;
}

struct Shape {
    const char* label;
    TriangleMesh mesh;
    const char* group;
};

void PrintTo(const Shape& shape, std::ostream* out) {
    *out << shape.label;
}

TriangleMesh hexagon_bolt() {
    return joined(prism(6, 1.0, 0.0, 0.7), prism(48, 0.5, -3.0, 0.0));
}

// A mirror plane, z = 0, is no turn.
TriangleMesh angle_bracket(double arm, double other) {
    return extruded({{0, 0}, {arm, 0}, {arm, 0.4}, {0.4, 0.4}, {0.4, other}, {0, other}}, -1, 1,
                    {0.2, 0.2});
}

std::vector<Shape> shapes() {
    return {
        {"box", box({1, 2, 3}), "D2"},
        {"nearly_square_box", box({1, 1.1F, 1.25F}), "D2"},
        {"square_prism", box({1, 1, 2}), "D4"},
        {"thin_square_plate", box({1, 1, 0.05F}), "D4"},
        {"cube", box({1, 1, 1}), "O"},
        {"octahedron", octahedron(), "O"},
        {"tetrahedron", tetrahedron(), "T"},
        {"icosahedron", icosahedron(), "I"},
        {"hexagonal_prism", prism(6, 1.0, -0.5, 0.5), "D6"},
        {"hexagonal_nut",
         joined(prism(6, 1.0, -0.4, 0.4), turned_inside_out(prism(48, 0.5, -0.4, 0.4))), "D6"},
        // Principal moments are (nearly) equal, so that they don't tell the axis.
        {"compact_heptagonal_prism", prism(7, 1.0, -0.85, 0.85), "D7"},
        {"compact_cylinder", prism(64, 1.0, -0.87, 0.87), "D-infinity"},
        {"cylinder", prism(64, 1.0, -2.0, 2.0), "D-infinity"},
        {"cone", revolved({{0, -1}, {1, -1}, {0, 1}}, 64), "C-infinity"},
        {"sphere", sphere(1.0), "sphere"},
        {"torus", torus(1.0, 0.3), "D-infinity"},
        // Half a turn about the middle of the groove.
        {"cylinder_with_keyway", keyed_cylinder(0.2), "C2"},
        {"cylinder_with_keyway_and_step", joined(keyed_cylinder(0.2), prism(64, 1.3, 1.5, 1.8)),
         "C1"},
        {"l_bracket", angle_bracket(3.0, 2.0), "C1"},
        {"l_bracket_of_equal_arms", angle_bracket(3.0, 3.0), "C2"},
        {"gear_of_12_teeth", gear(12, 0.85, 1.0, 0.3), "D12"},
        {"gear_of_37_teeth", gear(37, 0.93, 1.0, 0.3), "D37"},
        {"ratchet_of_12_teeth", gear(12, 0.85, 1.0, 0.3, 0.15), "C12"},
        {"hexagon_bolt", hexagon_bolt(), "C6"},
        {"lopsided", lopsided(), "C1"},
    };
}

class KnownShape : public testing::TestWithParam<Shape> {};

TEST_P(KnownShape, IsFoundAsMade) {
    EXPECT_EQ(symmetry_name(find_symmetry(GetParam().mesh)), GetParam().group);
}

TEST_P(KnownShape, IsFoundInOtherTriangles) {
    const TriangleMesh mesh = remeshed(GetParam().mesh, 11);
    EXPECT_EQ(symmetry_name(find_symmetry(mesh)), GetParam().group);
}

TEST_P(KnownShape, IsFoundTurnedMovedAndInMeters) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        const TriangleMesh moved = transformed(GetParam().mesh, random_pose(seed, 5.0));
        EXPECT_EQ(symmetry_name(find_symmetry(scaled(moved, 0.001))), GetParam().group);
    }
}

TEST_P(KnownShape, ReportsAnExactGroup) {
    const TriangleMesh moved = transformed(GetParam().mesh, random_pose(7, 5.0));
    const Symmetry symmetry = find_symmetry(moved);
    std::vector<Pose> group = symmetry.turns;
    group.push_back(Pose::Identity());
    const auto holds = [&](const Pose& sought) {
        return std::any_of(group.begin(), group.end(), [&](const Pose& member) {
            return (member.matrix() - sought.matrix()).cwiseAbs().maxCoeff() < 1e-9;
        });
    };
    for (const Pose& a : group) {
        EXPECT_LT((a.linear() * a.linear().transpose() - Mat3d::Identity()).norm(), 1e-9);
        EXPECT_NEAR(a.linear().determinant(), 1.0, 1e-9);
        EXPECT_LT((a * symmetry.center - symmetry.center).norm(), 1e-9);
        EXPECT_TRUE(holds(a.inverse()));
        for (const Pose& b : group) {
            if (group.size() < 40) {
                EXPECT_TRUE(holds(a * b));
            }
        }
    }
    for (std::size_t i = 0; i < group.size(); ++i) {  // all different
        for (std::size_t j = 0; j < i; ++j) {
            EXPECT_GT((group[i].linear() - group[j].linear()).norm(), 0.05);
        }
    }
    for (const ContinuousAxis& axis : symmetry.axes) {
        EXPECT_NEAR(axis.direction.norm(), 1.0, 1e-9);
        for (const Pose& a : symmetry.turns) {  // half turns across
            EXPECT_LT((a.linear() * axis.direction + axis.direction).norm(), 1e-9);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Symmetry, KnownShape, testing::ValuesIn(shapes()),
                         [](const auto& shape) { return shape.param.label; });

double angle_between(const Vec3d& a, const Vec3d& b) {
    return std::atan2(a.cross(b).norm(), std::abs(a.dot(b)));
}

TEST(FindSymmetry, FindsAxesWhereTheyAre) {
    const Pose T_new_old = random_pose(3, 5.0);
    const Vec3d z = T_new_old.linear().col(2);
    const Symmetry bolt = find_symmetry(transformed(hexagon_bolt(), T_new_old));
    ASSERT_EQ(bolt.turns.size(), 5U);
    for (std::size_t k = 0; k < 5; ++k) {
        const Eigen::AngleAxisd turn(Eigen::Matrix3d(bolt.turns[k].linear()));
        EXPECT_LT(angle_between(turn.axis(), z), 0.003);
        EXPECT_NEAR(std::min(turn.angle(), 2.0 * kPi - turn.angle()),
                    std::min(k + 1.0, 5.0 - k) * kPi / 3.0, 1e-9);
        // The line is where it was: its distance to the mesh's own axis.
        EXPECT_LT((T_new_old.translation() - bolt.center).cross(z).norm(), 0.005);
    }
    const Symmetry cone =
        find_symmetry(transformed(revolved({{0, -1}, {1, -1}, {0, 1}}, 64), T_new_old));
    ASSERT_EQ(cone.axes.size(), 1U);
    EXPECT_LT(angle_between(cone.axes[0].direction, z), 0.003);
    EXPECT_LT((T_new_old.translation() - cone.axes[0].point).cross(z).norm(), 0.005);
    const Symmetry cube = find_symmetry(transformed(box({1, 1, 1}), T_new_old));
    EXPECT_LT((T_new_old.translation() - cube.center).norm(), 0.005);
}

// Every turn found for a moved model is the one found before, moved: S' = T S T^-1.
TEST(FindSymmetry, MovesWithTheModel) {
    const TriangleMesh mesh = prism(5, 1.0, -0.3, 0.5);
    const Symmetry before = find_symmetry(mesh);
    const Pose T_new_old = random_pose(8, 2.0);
    const Symmetry after = find_symmetry(transformed(mesh, T_new_old));
    ASSERT_EQ(before.turns.size(), 9U);
    ASSERT_EQ(after.turns.size(), 9U);
    for (const Pose& turn : before.turns) {
        const Pose moved = T_new_old * turn * T_new_old.inverse();
        double least = 10.0;
        for (const Pose& other : after.turns) {
            least = std::min(least, (moved.matrix() - other.matrix()).cwiseAbs().maxCoeff());
        }
        EXPECT_LT(least, 0.01);
    }
}

// The surface and what a dent of this depth and width leaves of its symmetry.
TEST(FindSymmetry, ToleranceDecidesAboutDents) {
    const auto dented = [](double depth) {
        return star_shape(120, 240, [=](const Vec3d& d) {
            const double off = std::acos(std::clamp(d.dot(Vec3d(0.6, 0.0, 0.8)), -1.0, 1.0));
            return off < 0.3 ? 1.0 - depth * (1.0 + std::cos(off / 0.3 * kPi)) / 2.0 : 1.0;
        });
    };
    EXPECT_EQ(symmetry_name(find_symmetry(dented(0.01))), "sphere");  // half of the tolerance
    const Symmetry deep = find_symmetry(dented(0.08));
    ASSERT_EQ(symmetry_name(deep), "C-infinity");
    EXPECT_LT(angle_between(deep.axes[0].direction, {0.6, 0.0, 0.8}), 0.02);
    EXPECT_EQ(symmetry_name(find_symmetry(dented(0.08), {.tolerance = 0.05})), "sphere");
    EXPECT_EQ(symmetry_name(find_symmetry(dented(0.01), {.tolerance = 0.002})), "C-infinity");
}

TEST(FindSymmetry, ToleranceDecidesAboutGroovesAndSides) {
    EXPECT_EQ(symmetry_name(find_symmetry(keyed_cylinder(0.02))), "D-infinity");
    EXPECT_EQ(symmetry_name(find_symmetry(keyed_cylinder(0.1))), "C2");
    EXPECT_EQ(symmetry_name(find_symmetry(box({1.0F, 1.0F, 1.01F}))), "O");
    EXPECT_EQ(symmetry_name(find_symmetry(box({1.0F, 1.0F, 1.1F}))), "D4");
    EXPECT_EQ(symmetry_name(find_symmetry(prism(24, 1.0, -1.0, 1.0))), "D-infinity");
    EXPECT_EQ(symmetry_name(find_symmetry(prism(24, 1.0, -1.0, 1.0), {.tolerance = 0.002})), "D24");
}

TEST(FindSymmetry, MaxOrderBoundsTheSearch) {
    EXPECT_EQ(symmetry_name(find_symmetry(gear(12, 0.85, 1.0, 0.3), {.max_order = 10})), "D6");
}

// A plate with only its upper side: what faces up must not be laid upon what faces down.
TEST(FindSymmetry, TellsInsideFromOutside) {
    TriangleMesh sheet;
    sheet.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    EXPECT_EQ(symmetry_name(find_symmetry(sheet)), "C4");
}

TEST(FindSymmetry, TakesTheVisibleSurfaceAlone) {
    // A cube within which a small box lies off the middle: from outside a cube.
    const TriangleMesh cube = box({1, 1, 1});
    const Pose aside(Eigen::Translation3d(0.4, 0.2, 0.1));
    const TriangleMesh filled = joined(cube, transformed(box({0.2F, 0.3F, 0.4F}), aside));
    EXPECT_EQ(symmetry_name(find_symmetry(filled)), "C1");
    const SurfaceSamples samples = sample_evenly(cube, 3000);
    PointCloud surface;
    surface.points = samples.points;
    surface.normals = samples.normals;
    surface.points.emplace_back(Vec3f::Constant(std::numeric_limits<float>::quiet_NaN()));
    surface.normals.emplace_back(0.0F, 0.0F, 1.0F);
    EXPECT_EQ(symmetry_name(find_symmetry(surface, std::sqrt(12.0))), "O");
}

TEST(FindSymmetry, IsTheSameForAnyNumberOfThreads) {
    const TriangleMesh mesh = transformed(gear(12, 0.85, 1.0, 0.3), random_pose(4));
    set_thread_count(1);
    const Symmetry one = find_symmetry(mesh);
    set_thread_count(0);
    const Symmetry many = find_symmetry(mesh);
    ASSERT_EQ(one.turns.size(), many.turns.size());
    for (std::size_t i = 0; i < one.turns.size(); ++i) {
        EXPECT_EQ(one.turns[i].matrix(), many.turns[i].matrix());
    }
}

TEST(FindSymmetry, OrdersTurnsByAxisAndAngle) {
    const Symmetry prism5 = find_symmetry(prism(5, 1.0, -0.3, 0.5));
    ASSERT_EQ(prism5.turns.size(), 9U);
    for (int k = 0; k < 4; ++k) {
        const Mat3d turn = prism5.turns[static_cast<std::size_t>(k)].linear();
        // Counter-clockwise about +z, by one step more each.
        EXPECT_NEAR(turn(0, 0), std::cos(2.0 * kPi * (k + 1) / 5), 0.01);
        EXPECT_NEAR(turn(1, 0), std::sin(2.0 * kPi * (k + 1) / 5), 0.01);
    }
}

TEST(FindSymmetry, RejectsWhatItCannotUse) {
    const TriangleMesh mesh = box({1, 1, 1});
    EXPECT_THROW(find_symmetry(mesh, {.tolerance = 0.0}), InvalidInput);
    EXPECT_THROW(find_symmetry(mesh, {.tolerance = 0.06}), InvalidInput);
    EXPECT_THROW(find_symmetry(mesh, {.tolerance = std::nan("")}), InvalidInput);
    EXPECT_THROW(find_symmetry(mesh, {.outliers = -0.1}), InvalidInput);
    EXPECT_THROW(find_symmetry(mesh, {.max_order = 1}), InvalidInput);
    EXPECT_THROW(find_symmetry(mesh, {.samples = 10}), InvalidInput);
    const SurfaceSamples samples = sample_uniformly(mesh, 1000);
    PointCloud surface;
    surface.points = samples.points;
    EXPECT_THROW(find_symmetry(surface, 3.5), InvalidInput);  // no normals
    surface.normals = samples.normals;
    EXPECT_NO_THROW(find_symmetry(surface, 3.5));
    EXPECT_THROW(find_symmetry(surface, 1.0), InvalidInput);  // larger than that
    EXPECT_THROW(find_symmetry(surface, 0.0), InvalidInput);
    EXPECT_THROW(find_symmetry(surface, std::nan("")), InvalidInput);
    surface.points.resize(99);
    surface.normals.resize(99);
    EXPECT_THROW(find_symmetry(surface, 3.5), InvalidInput);
}

}  // namespace
}  // namespace ostraka
