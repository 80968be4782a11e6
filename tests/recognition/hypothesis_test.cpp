// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/hypothesis.hpp"

#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

TEST(GatherEvidence, TheTruthIsSupported) {
    for (const std::uint32_t model : {kCorner, kPlate}) {
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            const SimulatedScene scene = alone(model, seed);
            const Scan scan = prepared(scene);
            const Evidence e =
                gather_evidence(scan, probe(model), scene.objects[0].T_scene_model, tolerance());
            EXPECT_EQ(e.visible, e.support + e.hidden + e.violation + e.missing + e.unsure);
            EXPECT_GT(e.visible, 60);
            EXPECT_GT(e.support, e.visible * 5 / 10);
            EXPECT_LT(e.violation, e.visible / 10);
            EXPECT_EQ(e.sunk, 0);
        }
    }
}

TEST(GatherEvidence, WhatWouldHideTheScanIsViolatedAndWhatItHidesIsNot) {
    const SimulatedScene scene = tabletop({kPlate}, 2);
    const Scan scan = prepared(scene);
    const Pose& truth = scene.objects[0].T_scene_model;
    const Vec3d away = (truth * models().shapes[kPlate].center).normalized();
    Pose nearer = truth;
    nearer.translation() -= 60.0 * away;
    const Evidence in_front = gather_evidence(scan, probe(kPlate), nearer, tolerance());
    EXPECT_GT(in_front.violation, in_front.visible * 9 / 10);
    Pose farther = truth;
    farther.translation() += 300.0 * away;
    const Evidence behind = gather_evidence(scan, probe(kPlate), farther, tolerance());
    EXPECT_EQ(behind.hidden, behind.visible);
    EXPECT_EQ(behind.sunk, behind.visible);
    EXPECT_LT(quick_score(behind), 0.0);
    EXPECT_LT(quick_score(in_front), quick_score(behind));
}

TEST(GatherEvidence, BesideTheScanEverythingIsMissing) {
    const SimulatedScene scene = alone(kCorner, 1);
    Pose beside = scene.objects[0].T_scene_model;
    beside.translation().x() += 300.0;
    const Evidence e = gather_evidence(prepared(scene), probe(kCorner), beside, tolerance());
    EXPECT_EQ(e.missing + e.unsure, e.visible);  // unsure: seen at a slant
    EXPECT_GT(e.missing, e.visible / 2);
    EXPECT_GT(e.visible, 0);
}

TEST(GatherEvidence, SurfaceThatFacesElsewhereContradicts) {
    // A flat face against a table seen at a slant: right place, wrong direction.
    const SimulatedScene scene = tabletop({kPlate}, 2);
    const Scan scan = prepared(scene);
    const Pose& truth = scene.objects[0].T_scene_model;
    const Vec3d center = models().shapes[kPlate].center;
    const Pose turned = disturbed(truth, center, kPi / 2.0, 0.0, 8);
    const Evidence right = gather_evidence(scan, probe(kPlate), truth, tolerance());
    const Evidence wrong = gather_evidence(scan, probe(kPlate), turned, tolerance());
    EXPECT_LT(right.violation, right.visible / 8);
    EXPECT_GT(wrong.violation + wrong.missing, wrong.visible / 4);
}

TEST(QuickScore, IsHighestAtTheTruth) {
    for (const std::uint32_t model : {kCorner, kPlate}) {
        const SimulatedScene scene = tabletop({kCorner, kPlate}, 3);
        const Scan scan = prepared(scene);
        const Pose& truth = scene.objects[model].T_scene_model;
        const double best = quick_score(gather_evidence(scan, probe(model), truth, tolerance()));
        EXPECT_GT(best, 0.1);
        for (std::uint64_t seed = 0; seed < 40; ++seed) {
            const Pose other = disturbed(truth, models().shapes[model].center, 0.35, 15.0, seed);
            EXPECT_LT(quick_score(gather_evidence(scan, probe(model), other, tolerance())), best);
        }
    }
}

TEST(QuickScore, CountsSupportAgainstContradiction) {
    EXPECT_DOUBLE_EQ(quick_score({}), 0.0);
    EXPECT_DOUBLE_EQ(quick_score({.visible = 512, .support = 512, .fit = 512.0}), 1.0);
    EXPECT_DOUBLE_EQ(quick_score({.visible = 200, .support = 100, .violation = 100, .fit = 100.0}),
                     0.0);
    EXPECT_DOUBLE_EQ(quick_score({.visible = 128, .hidden = 128}), 0.0);
    EXPECT_LT(quick_score({.visible = 128, .missing = 128}), 0.0);
    EXPECT_LT(quick_score({.visible = 128, .support = 128, .fit = 60.0}),
              quick_score({.visible = 128, .support = 128, .fit = 100.0}));
    EXPECT_LT(quick_score({.visible = 128, .hidden = 128, .sunk = 128}), 0.0);
}

TEST(SourceName, NamesBoth) {
    EXPECT_EQ(source_name(HypothesisSource::segment), "segment");
    EXPECT_EQ(source_name(HypothesisSource::keypoints), "keypoints");
    EXPECT_EQ(source_name(HypothesisSource::faces), "faces");
}

}  // namespace
}  // namespace ostraka
