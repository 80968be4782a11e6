// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/verification.hpp"

#include <algorithm>

#include "ostraka/recognition/confidence.hpp"
#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

Verified verify_at(const Scan& scan, std::uint32_t model, const Pose& T_scene_model) {
    Verified v =
        verify(scan, probe(model), {.model = model, .T_scene_model = T_scene_model}, tolerance());
    v.confidence = too_small(v) ? 0.0 : general_confidence().confidence(features_of(v));
    return v;
}

TEST(Verify, TheTruthIsConfidentAndAsVisibleAsItIs) {
    for (std::uint64_t number = 0; number < 4; ++number) {
        const SimulatedScene scene = tabletop({kCorner, kPlate}, number);
        const Scan scan = prepared(scene);
        for (const TrueObject& object : scene.objects) {
            const Verified v = verify_at(scan, object.model, object.T_scene_model);
            EXPECT_EQ(v.silhouette,
                      v.support + v.hidden + v.violation + v.backdrop + v.missing + v.unsure);
            EXPECT_EQ(v.cells.size(), v.support);
            EXPECT_TRUE(std::is_sorted(v.cells.begin(), v.cells.end()));
            EXPECT_GT(v.confidence, 0.9);
            EXPECT_NEAR(v.visible_fraction, object.visible_fraction, 0.25);
            EXPECT_LT(v.inlier_rms, 0.3 * library().settings.sampling);
            EXPECT_LT(v.sunk, 0.01);
            EXPECT_LT(v.outline.open, 0.2);
        }
    }
}

TEST(Verify, SupportIsWhatTheSensorSawOfTheObject) {
    // What the sensor saw of the object is what supports its true pose.
    const SimulatedScene scene = alone(kPlate, 2);
    const Scan scan = prepared(scene);
    const Verified v = verify_at(scan, kPlate, scene.objects[0].T_scene_model);
    std::size_t supported = 0;
    std::size_t on_object = 0;
    for (std::size_t i = 0; i < scene.labels.size(); ++i) {
        if (scene.labels[i] != 0) continue;
        ++on_object;
        const std::uint32_t cell = scan.ranges.cell_of(scene.cloud.points[i]);
        if (std::binary_search(v.cells.begin(), v.cells.end(), cell)) ++supported;
    }
    EXPECT_GT(supported, on_object * 3 / 4);
}

TEST(Verify, AnotherModelOrPlaceIsNotBelieved) {
    const SimulatedScene scene = tabletop({kCorner, kPlate}, 1);
    const Scan scan = prepared(scene);
    for (const TrueObject& object : scene.objects) {
        const std::uint32_t other = 1 - object.model;
        EXPECT_LT(verify_at(scan, other, object.T_scene_model).confidence, 0.5);
        Pose nearer = object.T_scene_model;
        nearer.translation() *= 0.8;
        const Verified floating = verify_at(scan, object.model, nearer);
        EXPECT_LT(floating.confidence, 0.1);
        EXPECT_GT(floating.violation, floating.silhouette * 8 / 10);
        Pose below = object.T_scene_model;
        below.translation() -= 200.0 * scan.table->normal;
        const Verified sunk = verify_at(scan, object.model, below);
        EXPECT_LT(sunk.confidence, 0.1);
        EXPECT_GT(sunk.sunk, 0.9);
    }
}

TEST(Verify, WhatIsOutOfSightCantBeBelowTheTableEither) {
    // Of the plate upside down, with its pillars through the table, only the base is seen.
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(-300, -300, -20), Vec3f(300, 300, 0));
    testing::add_box(mesh, Vec3f(-45, -30, 0), Vec3f(45, 30, 8));
    const SimulatedScene scene = scan_of(mesh, Vec3d(0, 0, 500), 0.0);
    const Scan scan = prepared(scene);
    ASSERT_TRUE(scan.table);
    Pose T_mesh_plate = Pose::Identity();
    T_mesh_plate.linear() = Vec3d(1.0, -1.0, -1.0).asDiagonal();
    T_mesh_plate.translation() = Vec3d(-45.0, 30.0, 8.0);
    const Pose T_scene_plate = scene.objects[0].T_scene_model * T_mesh_plate;
    const Verified v = verify_at(scan, kPlate, T_scene_plate);
    EXPECT_GT(v.visible_fraction, 0.9);
    EXPECT_EQ(v.violation, 0U);
    std::size_t below = 0;
    const std::vector<Vec3f>& points = library().models[kPlate].surface.points;
    for (const Vec3f& point : points) {
        const Vec3d at = T_scene_plate * point.cast<double>();
        const double height = scan.table->normal.dot(at) - scan.table->offset;
        below += height < -2.0 * tolerance() ? 1 : 0;
    }
    const auto share = static_cast<double>(below) / static_cast<double>(points.size());
    EXPECT_GT(share, 0.1);
    EXPECT_NEAR(v.sunk, share, 0.03);
    EXPECT_LT(v.confidence, 0.01);
}

TEST(Verify, OutOfSightThereIsNoSilhouette) {
    const SimulatedScene scene = alone(kCorner, 0);
    Pose behind = scene.objects[0].T_scene_model;
    behind.translation() = -behind.translation();
    const Verified v = verify_at(prepared(scene), kCorner, behind);
    EXPECT_EQ(v.support, 0U);
    EXPECT_EQ(v.confidence, 0.0);
    EXPECT_EQ(v.visible_fraction, 0.0);
    EXPECT_EQ(v.inlier_rms, 0.0);
}

TEST(Verify, WhatIsHiddenIsNoContradiction) {
    // The corner model far behind the table: hidden, and nothing else.
    const SimulatedScene scene = tabletop({kPlate}, 0);
    Pose behind = scene.objects[0].T_scene_model;
    behind.translation() *= 2.0;
    const Verified v = verify_at(prepared(scene), kCorner, behind);
    EXPECT_EQ(v.violation, 0U);
    EXPECT_GT(v.hidden, v.silhouette * 9 / 10);
    EXPECT_LT(v.confidence, 0.1);
}

TEST(Verify, AFaceLaidIntoAWallIsNotBelieved) {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(-300, -300, -20), Vec3f(300, 300, 0));
    for (const double noise : {0.0, 0.5}) {
        const SimulatedScene scene = scan_of(mesh, Vec3d(100, -150, 380), noise);
        const double sampling = library().settings.sampling;
        const Scan scan = prepare_scan(scene.cloud, sampling, 1000.0, {.remove_plane = false});
        ASSERT_FALSE(scan.table);
        Pose T_wall_plate = Pose::Identity();  // its flat underside is the wall's surface
        T_wall_plate.linear() = Vec3d(1.0, -1.0, -1.0).asDiagonal();
        const Verified v = verify_at(scan, kPlate, scene.objects[0].T_scene_model * T_wall_plate);
        EXPECT_GT(v.visible_fraction, 0.8);
        EXPECT_GT(v.outline.open, 0.8);
        EXPECT_LT(v.confidence, 0.1);
        // The wall is too large to be the plate's, though no larger than the largest model.
        const Scan with_backdrop = prepare_scan(scene.cloud, sampling, 1000.0, {});
        const Verified w =
            verify_at(with_backdrop, kPlate, scene.objects[0].T_scene_model * T_wall_plate);
        EXPECT_GT(w.backdrop, w.silhouette * 8 / 10);
        EXPECT_LT(w.confidence, 0.01);
    }
}

// However noisy the scan, the right pose fits as is to be expected, and one that is off doesn't.
TEST(Verify, TheDeviationIsWhatTheNoiseLetsExpect) {
    const double sampling = library().settings.sampling;
    for (const double noise : {0.1, 0.3, 0.6, 1.2}) {
        const SimulatedScene scene =
            scan_of(testing::corner_model(), Vec3d(150, -300, 260), noise * sampling);
        const Scan scan = prepared(scene);
        const Pose& truth = scene.objects[0].T_scene_model;
        const Verified right = verify_at(scan, kCorner, truth);
        EXPECT_LT(right.inlier_rms, 1.5 * right.expected_rms) << noise;
        EXPECT_GT(right.inlier_rms, 0.3 * right.expected_rms) << noise;
        Pose off = truth;
        off.translation().z() += 2.0 * right.expected_rms + 0.3 * sampling;
        const Verified wrong = verify_at(scan, kCorner, off);
        EXPECT_GT(wrong.inlier_rms, 1.5 * wrong.expected_rms) << noise;
    }
}

// Where nothing was measured beside something nearer, the model may be in its shadow.
TEST(CheckCell, AMissingReturnInAShadowSaysNothing) {
    PointCloud wall;
    for (float y = -30.0F; y <= 30.0F; y += 0.5F) {
        for (float x = -30.0F; x <= 30.0F; x += 0.5F) {
            if (std::abs(x) > 5.0F || std::abs(y) > 5.0F) wall.points.emplace_back(x, y, 100.0F);
        }
    }
    const Scan scan{.cloud = wall, .ranges = RangeMap(wall, {}, wall, 1.0)};
    const auto verdict = [&](float range) {
        const SurfacePiece piece{Vec3f(0, 0, range), -Vec3f::UnitZ(), range};
        return check_cell(scan, scan.ranges.cell_of(piece.point), piece, 3.0F, 80.0F).verdict;
    };
    EXPECT_EQ(verdict(90.0F), CellVerdict::missing);
    // Five cells of 0.01 radians from the hole's rim.
    const double begin = 100.0 / (1.0 - 0.05 / kParallax);
    EXPECT_EQ(verdict(static_cast<float>(0.93 * begin)), CellVerdict::missing);
    EXPECT_EQ(verdict(static_cast<float>(1.10 * begin)), CellVerdict::unsure);
}

}  // namespace
}  // namespace ostraka
