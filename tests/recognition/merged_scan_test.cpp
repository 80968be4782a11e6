// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/merged_scan.hpp"

#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

// A model seen from all sides, as if scans had been merged; some way off the origin.
PointCloud all_around(std::uint32_t model, const Pose& T_scene_model) {
    PointCloud cloud;
    for (const Vec3f& point : library().models[model].surface.points) {
        cloud.points.push_back((T_scene_model * point.cast<double>()).cast<float>());
    }
    return cloud;
}

Pose some_pose(std::uint64_t seed) {
    Random random(seed);
    Pose pose = Pose::Identity();
    pose.linear() = random.rotation();
    pose.translation() = 300.0 * random.direction();
    return pose;
}

Scan merged(const PointCloud& cloud, const std::vector<Vec3f>& viewpoints = {}) {
    return prepare_scan(cloud, library().settings.sampling, 200.0,
                        {.viewpoint_known = false, .viewpoints = viewpoints});
}

// What stands on a table, the table included, seen from two sides.
PointCloud seen_from_two_sides(const std::vector<std::uint32_t>& chosen, SimulatedScene& first) {
    TabletopSettings settings;
    settings.spacing = 1.4;
    settings.min_elevation = settings.max_elevation = 0.9;
    std::vector<PlacedModel> placed;
    first = simulate_tabletop(models(), chosen, 3, settings);
    const Pose T_world_camera = first.T_camera_world.inverse();
    for (const TrueObject& object : first.objects) {
        placed.push_back({object.model, T_world_camera * object.T_scene_model});
    }
    SceneView other{.camera = first.camera, .T_camera_world = first.T_camera_world};
    other.T_camera_world.rotate(Eigen::AngleAxisd(2.5, Vec3d::UnitZ()));
    other.table_size = 8.0 * models().shapes[chosen[0]].diameter;
    const SimulatedScene second = simulate_scene(models(), placed, other);
    const Pose T_first_second = first.T_camera_world * other.T_camera_world.inverse();
    PointCloud cloud = remove_invalid(first.cloud);
    for (const Vec3f& point : remove_invalid(second.cloud).points) {
        cloud.points.push_back((T_first_second * point.cast<double>()).cast<float>());
    }
    return cloud;
}

TEST(MergedScan, ItsTruthIsSeenAllAround) {
    for (const std::uint32_t model : {kCorner, kPlate}) {
        const Pose truth = some_pose(model + 3);
        const Scan scan = merged(all_around(model, truth));
        const Verified v =
            verify(scan, probe(model), {.model = model, .T_scene_model = truth}, tolerance());
        EXPECT_GT(v.visible_fraction, 0.85);
        EXPECT_GT(v.agreement(), 0.9);
        EXPECT_LT(v.inlier_rms, 0.3 * library().settings.sampling);
        const Pose off = disturbed(truth, models().shapes[model].center, 1.2, 30.0, 5);
        const Verified w =
            verify(scan, probe(model), {.model = model, .T_scene_model = off}, tolerance());
        EXPECT_LT(w.agreement(), 0.7 * v.agreement());
        EXPECT_LT(quick_score(gather_evidence(scan, probe(model), off, tolerance())),
                  quick_score(gather_evidence(scan, probe(model), truth, tolerance())));
    }
}

TEST(MergedScan, PointsDeepInsideContradict) {
    const Pose truth = some_pose(5);
    PointCloud cloud = all_around(kCorner, truth);
    const auto inside = [&] {
        const Scan scan = merged(cloud);
        return verify(scan, probe(kCorner), {.model = kCorner, .T_scene_model = truth}, tolerance())
            .inside;
    };
    EXPECT_EQ(inside(), 0U);
    // Along the middle of the long arm, 10 from each side.
    Random random(1);
    for (int i = 0; i < 1500; ++i) {
        const Vec3d at(random.uniform(12.0, 68.0), random.uniform(9.0, 11.0),
                       random.uniform(9.0, 11.0));
        cloud.points.push_back((truth * at).cast<float>());
    }
    EXPECT_GT(inside(), 15U);
}

TEST(MergedScan, NothingIsBelowTheTable) {
    SimulatedScene first;
    const PointCloud cloud = seen_from_two_sides({kPlate, kCorner}, first);
    const Scan scan = prepare_scan(library(), cloud, {.viewpoint_known = false});
    ASSERT_TRUE(scan.table.has_value());
    const Pose& truth = first.objects[0].T_scene_model;
    const auto sunk = [&](const Pose& T) {
        return verify(scan, probe(kPlate), {.model = kPlate, .T_scene_model = T}, tolerance()).sunk;
    };
    EXPECT_EQ(sunk(truth), 0.0);
    Pose below = truth;
    below.translation() -= 200.0 * scan.table->normal;
    EXPECT_EQ(sunk(below), 1.0);
    const Evidence evidence = gather_evidence(scan, probe(kPlate), below, tolerance());
    EXPECT_EQ(evidence.sunk, evidence.samples);
    EXPECT_EQ(gather_evidence(scan, probe(kPlate), truth, tolerance()).sunk, 0);
}

TEST(MergedScan, OnlyAKnownViewpointContradicts) {
    const Pose truth = some_pose(8);
    const PointCloud cloud = all_around(kPlate, truth);
    const Vec3d center = truth * models().shapes[kPlate].center;
    const Vec3d eye = center + 600.0 * Vec3d(0.3, -0.4, 0.86);
    // The model as well between the sensor and where it is: the sensor saw through it.
    Pose nearer = truth;
    nearer.translation() += 250.0 * (eye - center).normalized();
    const Evidence unknown = gather_evidence(merged(cloud), probe(kPlate), nearer, tolerance());
    EXPECT_EQ(unknown.violation, 0);
    EXPECT_GT(unknown.missing, unknown.visible * 9 / 10);
    const Evidence known =
        gather_evidence(merged(cloud, {eye.cast<float>()}), probe(kPlate), nearer, tolerance());
    EXPECT_GT(known.violation, known.visible / 8);
    EXPECT_EQ(known.support, 0);
}

TEST(MergedScan, AnObjectIsRecognizedWhereverTheSensorsWere) {
    const Recognizer recognizer(library());
    const Pose truth = some_pose(21);
    const PointCloud cloud = all_around(kCorner, truth);
    const Recognition answer =
        recognizer.recognize(cloud, {.min_confidence = 0.1, .viewpoint_known = false});
    ASSERT_EQ(answer.objects.size(), 1U);
    EXPECT_EQ(answer.objects[0].model_index, kCorner);
    EXPECT_LT(pose_error(kCorner, truth, answer.objects[0].T_scene_model), 0.02);
}

TEST(MergedScan, ATableIsFoundAndCutAway) {
    SimulatedScene first;
    const PointCloud cloud = seen_from_two_sides({kPlate, kCorner}, first);
    const Scan scan = prepare_scan(library(), cloud, {.viewpoint_known = false});
    ASSERT_TRUE(scan.table.has_value());
    const Vec3d up = first.T_camera_world.linear() * Vec3d::UnitZ();
    EXPECT_GT(scan.table->normal.dot(up), 0.999);
    for (const Vec3f& point : scan.cloud.points) {
        const Vec3d at = first.T_camera_world.inverse() * point.cast<double>();
        EXPECT_GT(at.z(), 0.5 * scan.sampling);
    }
    const Recognition answer = recognize(library(), cloud, {.viewpoint_known = false});
    EXPECT_TRUE(answer.table_found);
    EXPECT_EQ(answer.objects.size(), 2U);
    for (const RecognizedObject& object : answer.objects) {
        const Pose& truth = first.objects[object.model_index == kPlate ? 0 : 1].T_scene_model;
        EXPECT_LT(pose_error(object.model_index, truth, object.T_scene_model), 0.02);
    }
}

TEST(MergedScan, NothingButATableIsNothing) {
    PointCloud cloud;
    for (int y = -100; y < 100; ++y) {
        for (int x = -100; x < 100; ++x) cloud.points.emplace_back(2.0F * x, 2.0F * y, 0.0F);
    }
    const Recognition answer = recognize(library(), cloud, {.viewpoint_known = false});
    EXPECT_TRUE(answer.table_found);
    EXPECT_TRUE(answer.objects.empty());
}

}  // namespace
}  // namespace ostraka
