// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/parts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "ostraka/base/error.hpp"
#include "simulation/closed_mesh.hpp"

namespace ostraka {
namespace {

Vec3f extent_of(const TriangleMesh& mesh) {
    Vec3f low = mesh.vertices[0];
    Vec3f high = low;
    for (const Vec3f& v : mesh.vertices) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
    return high - low;
}

class EachPart : public testing::TestWithParam<PartKind> {};

TEST_P(EachPart, IsClosedInOnePieceAndOfPlausibleSize) {
    for (const std::uint64_t seed : {0U, 1U, 77U}) {
        SCOPED_TRACE(seed);
        const TriangleMesh mesh = make_part(GetParam(), {.seed = seed});
        const ClosedMeshReport report = examine(mesh);
        EXPECT_TRUE(report.closed);
        EXPECT_TRUE(report.manifold);
        EXPECT_EQ(report.components, 1);
        EXPECT_EQ(report.folds, 0);
        EXPECT_EQ(report.empty_triangles, 0);
        EXPECT_GT(report.volume, 5000.0);
        EXPECT_GE(extent_of(mesh).maxCoeff(), 40.0F);
        EXPECT_LE(extent_of(mesh).maxCoeff(), 150.0F);
        EXPECT_LE(mesh.triangles.size(), 9'000U);
    }
}

TEST_P(EachPart, LiesOnItsSolid) {
    const Solid solid = part_solid(GetParam(), 2);
    const TriangleMesh mesh = make_part(GetParam(), {.seed = 2});
    double area_against = 0.0;  // of triangles that look against the field
    double sum = 0.0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3d middle =
            (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]).cast<double>() / 3.0;
        const Vec3d area = area_vector(mesh, t);
        const double off = solid.distance(middle);
        EXPECT_LT(std::abs(off), 0.5);  // 0.4 of a cell, where a detail is thinner than two
        sum += off * off * area.norm();
        if (area.dot(solid.gradient(middle, 1e-3)) < 0.0) area_against += area.norm();
    }
    EXPECT_LT(std::sqrt(sum / (2.0 * surface_area(mesh))), 0.04);
    EXPECT_LT(area_against, 1e-3 * 2.0 * surface_area(mesh));
}

TEST_P(EachPart, IsTheSameTwiceAndVariesWithTheSeed) {
    const PartSettings settings{.seed = 3, .resolution = 64};
    const TriangleMesh a = make_part(GetParam(), settings);
    const TriangleMesh b = make_part(GetParam(), settings);
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vec3f)),
              0);
    const TriangleMesh other = make_part(GetParam(), {.seed = 4, .resolution = 64});
    EXPECT_GT((extent_of(a) - extent_of(other)).norm(), 0.1F);
}

INSTANTIATE_TEST_SUITE_P(Parts, EachPart, testing::ValuesIn(all_parts()),
                         [](const auto& param) { return std::string(part_name(param.param)); });

// Counted on the drawing.
TEST(Parts, HaveAsManyHolesAsTheirDrawings) {
    const auto genus = [](PartKind kind) { return examine(make_part(kind)).genus(); };
    EXPECT_EQ(genus(PartKind::flange), 7);  // bore, 6 bolts
    EXPECT_EQ(genus(PartKind::bolt), 0);
    EXPECT_EQ(genus(PartKind::l_bracket), 3);     // 2 holes, a slot
    EXPECT_EQ(genus(PartKind::gear), 6);          // bore, 5 lightening holes
    EXPECT_EQ(genus(PartKind::tee), 13);          // 3 mouths (2), 4 + 4 + 3 bolts
    EXPECT_EQ(genus(PartKind::elbow), 10);        // 3 mouths (2), 4 + 4 bolts
    EXPECT_EQ(genus(PartKind::valve_body), 15);   // 4 mouths (3), 4 + 4 + 4 bolts
    EXPECT_EQ(genus(PartKind::pump_housing), 8);  // 3 mouths (2), 4 bolts, 2 in the foot
    EXPECT_EQ(genus(PartKind::heat_sink), 3);
    EXPECT_EQ(genus(PartKind::connecting_rod), 5);  // 2 eyes, 2 bolts, oil
}

TEST(Parts, DifferFromEachOther) {
    struct Signature {
        double volume, area;
        Vec3f extent;
    };
    std::vector<Signature> all;
    for (const PartKind kind : all_parts()) {
        const TriangleMesh mesh = make_part(kind, {.resolution = 64});
        all.push_back({examine(mesh).volume, surface_area(mesh), extent_of(mesh)});
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const double volume = std::abs(std::log(all[i].volume / all[j].volume));
            const double area = std::abs(std::log(all[i].area / all[j].area));
            const double extent = (all[i].extent - all[j].extent).norm() / 100.0;
            EXPECT_GT(volume + area + extent, 0.1) << i << " and " << j;
        }
    }
}

TEST(Parts, SizeScalesEveryLength) {
    const TriangleMesh one = make_part(PartKind::cam, {.resolution = 64});
    const TriangleMesh two = make_part(PartKind::cam, {.size = 2.0, .resolution = 64});
    ASSERT_EQ(one.vertices.size(), two.vertices.size());
    EXPECT_EQ(one.triangles, two.triangles);
    for (std::size_t i = 0; i < one.vertices.size(); ++i) {
        EXPECT_LT((2.0F * one.vertices[i] - two.vertices[i]).norm(), 1e-4F);
    }
}

TEST(Parts, NamesAreUniqueAndReadBack) {
    EXPECT_GE(all_parts().size(), 14U);
    for (const PartKind kind : all_parts()) EXPECT_EQ(parse_part(part_name(kind)), kind);
    EXPECT_FALSE(parse_part("teapot").has_value());
    EXPECT_FALSE(parse_part("").has_value());
}

TEST(Parts, RejectsSettingsOutOfRange) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(make_part(PartKind::cam, {.size = 0.0}), InvalidInput);
    EXPECT_THROW(make_part(PartKind::cam, {.size = nan}), InvalidInput);
    EXPECT_THROW(make_part(PartKind::cam, {.resolution = 63}), InvalidInput);
    EXPECT_THROW(make_part(PartKind::cam, {.resolution = 513}), InvalidInput);
    EXPECT_THROW(make_part(PartKind::cam, {.tolerance = 0.0}), InvalidInput);
    EXPECT_THROW(part_name(static_cast<PartKind>(999)), InvalidInput);
}

}  // namespace
}  // namespace ostraka
