// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/outline.hpp"

#include "ostraka/recognition/confidence.hpp"
#include "ostraka/recognition/verdict_image.hpp"
#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

constexpr float kLength = 90.0F;  // of the plate's flat underside, at z = 0 and facing down
constexpr float kWidth = 60.0F;

// The plate verified in a scan of `mesh` from below, as if the mesh were the plate.
class FromBelow {
  public:
    explicit FromBelow(const TriangleMesh& mesh, const Vec3d& eye = Vec3d(45, 30, -400))
        : scene_(scan_of(mesh, eye, 0.1)),
          scan_(prepared(scene_)),
          verified_(verify(scan_, probe(kPlate),
                           {.model = kPlate, .T_scene_model = scene_.objects[0].T_scene_model},
                           tolerance(), &detail_)) {}
    const Verified& verified() const { return verified_; }
    const OutlineEvidence& outline() const { return verified_.outline; }
    // The outline if so many cells at the rim couldn't be judged.
    OutlineEvidence outline_with_edge(int cells) const;
    double cell() const { return scan_.cell; }
    double confidence() const { return general_confidence().confidence(features_of(verified_)); }

  private:
    SimulatedScene scene_;
    Scan scan_;
    CellVerdicts detail_;
    Verified verified_;
};

OutlineEvidence FromBelow::outline_with_edge(int cells) const {
    std::vector<CellVerdict> verdicts = detail_.verdicts;
    for (int pass = 0; pass < cells; ++pass) {
        const std::vector<CellVerdict> before = verdicts;
        const VerdictImage image(scan_.ranges, detail_.cells, before);
        for (std::size_t i = 0; i < before.size(); ++i) {
            if (before[i] != CellVerdict::support) continue;
            const int u = image.u(detail_.cells[i]);
            const int v = image.v(detail_.cells[i]);
            for (const auto& [du, dv] : kSides) {
                if (image.at(u + du, v + dv) == CellVerdict::support) continue;
                verdicts[i] = CellVerdict::unsure;
            }
        }
    }
    return judge_outline(scan_, detail_.cells, verdicts);
}

// The plate's underside is the floor of a tray, as seen from below.
TriangleMesh tray() {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(-5, -5, 0), Vec3f(kLength + 5, kWidth + 5, 8));
    testing::add_box(mesh, Vec3f(-5, -5, -20), Vec3f(0, kWidth + 5, 0));
    testing::add_box(mesh, Vec3f(kLength, -5, -20), Vec3f(kLength + 5, kWidth + 5, 0));
    testing::add_box(mesh, Vec3f(-5, -5, -20), Vec3f(kLength + 5, 0, 0));
    testing::add_box(mesh, Vec3f(-5, kWidth, -20), Vec3f(kLength + 5, kWidth + 5, 0));
    return mesh;
}

// The plate's underside is the floor of a channel without ends.
TriangleMesh channel() {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(0, -5, 0), Vec3f(kLength, kWidth + 5, 8));
    testing::add_box(mesh, Vec3f(0, -5, -20), Vec3f(kLength, 0, 0));
    testing::add_box(mesh, Vec3f(0, kWidth, -20), Vec3f(kLength, kWidth + 5, 0));
    return mesh;
}

// The plate's underside is the top of a truncated pyramid, with walls of 45 degrees.
TriangleMesh pyramid() {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(0, 0, 0), Vec3f(kLength, kWidth, 30));
    for (Vec3f& vertex : mesh.vertices) {
        if (vertex.z() == 0.0F) continue;
        vertex.x() += vertex.x() > 0.0F ? vertex.z() : -vertex.z();
        vertex.y() += vertex.y() > 0.0F ? vertex.z() : -vertex.z();
    }
    return mesh;
}

// The plate's underside is a piece of a larger one, though one too small for a table.
TriangleMesh larger() {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(0, 0, 0), Vec3f(kLength + 10, kWidth + 10, 8));
    return mesh;
}

// Along one long side of the plate's underside a wall rises from it, toward the sensor.
TriangleMesh with_wall() {
    TriangleMesh mesh = testing::plate_model();
    const std::size_t before = mesh.vertices.size();
    testing::add_box(mesh, Vec3f(0, kWidth, 0), Vec3f(kLength, kWidth + 40, 8));
    for (std::size_t i = before; i < mesh.vertices.size(); ++i) {
        mesh.vertices[i].z() -= mesh.vertices[i].y() - kWidth;
    }
    return mesh;
}

TEST(Outline, WhereSomethingGrowsOutOfTheSurfaceItIsJoined) {
    const FromBelow test(with_wall());
    EXPECT_NEAR(test.outline().joined, kLength / (2.0 * (kLength + kWidth)), 0.06);
    const FromBelow alone(testing::plate_model());
    EXPECT_EQ(alone.outline().joined, 0.0);
    EXPECT_LT(test.confidence(), alone.confidence());
}

// Over one long side of the plate's underside something is nearer to the sensor, and touches
// nothing.
TriangleMesh behind() {
    TriangleMesh mesh = testing::plate_model();
    testing::add_box(mesh, Vec3f(-20, kWidth - 20, -80), Vec3f(kLength + 20, kWidth + 40, -60));
    return mesh;
}

TEST(Outline, WhereSomethingElseIsInFrontItIsNotJoined) {
    const FromBelow test(behind());
    EXPECT_GT(test.verified().visible_fraction, 0.5);
    EXPECT_EQ(test.outline().joined, 0.0);
}

// By half a cell, as scans are.
TriangleMesh hardly_larger() {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(-1, -1, 0), Vec3f(kLength + 1, kWidth + 1, 8));
    return mesh;
}

TEST(Outline, OfAThinBrimThatCannotBeJudgedIsNotOpen) {
    const FromBelow test(hardly_larger());
    for (const int cells : {1, 2, 3}) {
        EXPECT_LT(test.outline_with_edge(cells).open, 0.05) << cells;
    }
    EXPECT_GT(FromBelow(larger()).outline_with_edge(2).open, 0.3);
}

TEST(Outline, OfWhatStandsAloneIsConfirmedAllAround) {
    const FromBelow test(testing::plate_model());
    EXPECT_LT(test.outline().open, 0.05);  // at corners
    EXPECT_EQ(test.outline().level, 0.0);
    EXPECT_EQ(test.outline().folded, 0.0);
    EXPECT_GT(test.confidence(), 0.9);
    // The two short sides are the direction with fewer cells. A side at a slant in the image has
    // up to the root of two as many.
    const double cells = 4.0 * kWidth / test.cell();
    EXPECT_GT(test.outline().ended, 0.8 * cells);
    EXPECT_LT(test.outline().ended, 1.5 * cells);
}

TEST(Outline, OfTheFloorOfATrayIsNowhereConfirmed) {
    const FromBelow test(tray());
    EXPECT_GT(test.verified().agreement(), 0.95);  // all that is seen of it fits
    EXPECT_LT(test.outline().ended, 2.0);
    EXPECT_LT(test.confidence(), FromBelow(testing::plate_model()).confidence());
}

TEST(Outline, OfTheFloorOfAChannelIsConfirmedInOneDirectionOnly) {
    const FromBelow test(channel());
    EXPECT_LT(test.outline().ended, 0.1 * FromBelow(testing::plate_model()).outline().ended);
}

TEST(Outline, WhereSomethingNearerBeginsJustAtItsEndItIsFenced) {
    EXPECT_GT(FromBelow(tray()).outline().fenced, 0.9);
    // Along the walls, not at the ends; less than their share of 0.6, as more cells can't be judged
    // at the foot of a wall.
    const double in_channel = FromBelow(channel()).outline().fenced;
    EXPECT_GT(in_channel, 0.3);
    EXPECT_LT(in_channel, kLength / (kLength + kWidth));
    EXPECT_EQ(FromBelow(testing::plate_model()).outline().fenced, 0.0);
    EXPECT_LT(FromBelow(behind()).outline().fenced, 0.1);  // which hides some of it, too
}

TEST(Outline, WhatIsFencedCountsBeyondHalfOfIt) {
    const auto fenced = [](double share) {
        Verified v;
        v.support = 1000;
        v.outline.fenced = share;
        return features_of(v)[static_cast<std::size_t>(Feature::fenced)];
    };
    EXPECT_EQ(fenced(0.0), 0.0);
    EXPECT_EQ(fenced(kOftenFenced), 0.0);
    EXPECT_DOUBLE_EQ(fenced(1.0), 1.0 - kOftenFenced);
}

TEST(Outline, WhereTheSurfaceBendsAwayAFaceIsMissing) {
    const FromBelow test(pyramid());
    // Beside a crease normals are of both sides: some of it seems level.
    EXPECT_GT(test.outline().folded, 0.5);
    EXPECT_GT(test.outline().folded + test.outline().level, 0.95);
    EXPECT_LT(test.outline().open, 0.1);
    EXPECT_LT(test.outline().ended, 0.1 * FromBelow(testing::plate_model()).outline().ended);
    EXPECT_LT(test.confidence(), 0.5);
}

TEST(Outline, WhereTheSurfaceGoesOnItIsOpen) {
    const FromBelow test(larger());
    // Two of four sides: one long, one short.
    EXPECT_NEAR(test.outline().open, 0.5, 0.1);
    EXPECT_LT(test.outline().folded, 0.05);
    EXPECT_LT(test.confidence(), 0.5);
}

// The plate's end face would be seen where the scan's bar goes on: inside the silhouette.
TEST(Outline, WhereTheSurfaceGoesOnPastAVisibleEndItIsOpen) {
    TriangleMesh longer;
    testing::add_box(longer, Vec3f(-15, 0, 0), Vec3f(kLength, kWidth, 8));
    const Vec3d eye(-300, 30, -300);
    EXPECT_LT(FromBelow(testing::plate_model(), eye).outline().open, 0.05);
    EXPECT_GT(FromBelow(longer, eye).outline().open, 0.1);
}

}  // namespace
}  // namespace ostraka
