// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/refinement.hpp"

#include <algorithm>

#include "ostraka/base/parallel.hpp"
#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

std::vector<Hypothesis> guesses(const SimulatedScene& scene, std::uint32_t model, double angle,
                                double shift, std::uint64_t count) {
    std::vector<Hypothesis> hypotheses;
    for (std::uint64_t i = 0; i < count; ++i) {
        const Pose pose = disturbed(scene.objects[0].T_scene_model, models().shapes[model].center,
                                    angle, shift, i);
        hypotheses.push_back({.model = model, .T_scene_model = pose});
    }
    return hypotheses;
}

TEST(RefinePose, ReturnsToTheTruth) {
    // The library's surface is sampled at 2 % of the diameter: poses are known to about that.
    for (const std::uint32_t model : {kCorner, kPlate}) {
        const SimulatedScene scene = tabletop({model}, 1);
        const Scan scan = prepared(scene);
        const Pose& truth = scene.objects[0].T_scene_model;
        for (std::uint64_t seed = 0; seed < 10; ++seed) {
            const Pose start = disturbed(truth, models().shapes[model].center, 0.06, 3.0, seed);
            const Pose rough = refine_pose(scan, probe(model), start, 300, 12.0);
            const Pose end = refine_pose(scan, probe(model), rough, 2000, 5.0);
            EXPECT_LT(pose_error(model, truth, end), 0.025) << model << ' ' << seed;
        }
    }
}

TEST(RefinePose, MostlyReturnsFromFifteenDegreesAndATenthOfTheDiameter) {
    for (const std::uint32_t model : {kCorner, kPlate}) {
        const SimulatedScene scene = tabletop({model}, 1);
        const Scan scan = prepared(scene);
        const Pose& truth = scene.objects[0].T_scene_model;
        const MeshShape& shape = models().shapes[model];
        int returned = 0;
        for (std::uint64_t seed = 0; seed < 40; ++seed) {
            const Pose start =
                disturbed(truth, shape.center, 15.0 * kPi / 180.0, 0.1 * shape.diameter, seed);
            const Pose rough = refine_from_afar(scan, probe(model), start, scan.sampling);
            const Pose end = refine_pose(scan, probe(model), rough, 2000, 2.5 * scan.sampling);
            returned += pose_error(model, truth, end) < 0.025 ? 1 : 0;
        }
        EXPECT_GE(returned, 36) << "of 40 of model " << model;
    }
}

TEST(RefinePose, StaysWhereNothingIsAround) {
    const SimulatedScene scene = alone(kCorner, 0);
    Pose far = scene.objects[0].T_scene_model;
    far.translation().x() += 1000.0;
    const Pose end = refine_pose(prepared(scene), probe(kCorner), far, 300, 10.0);
    EXPECT_LT((end.matrix() - far.matrix()).norm(), 1e-9);
}

TEST(RefineHypotheses, FindsTheTruthAmongRoughGuesses) {
    const SimulatedScene scene = tabletop({kPlate}, 0);
    const Scan scan = prepared(scene);
    const auto refined =
        refine_hypotheses(scan, probe(kPlate), guesses(scene, kPlate, 0.2, 10.0, 60), {});
    ASSERT_FALSE(refined.empty());
    EXPECT_LT(pose_error(kPlate, scene.objects[0].T_scene_model, refined[0].T_scene_model), 0.025);
}

TEST(RefineHypotheses, GivesFewDistinctOnesBestFirst) {
    const SimulatedScene scene = alone(kCorner, 7);
    const Scan scan = prepared(scene);
    const RecognitionSettings settings{.candidates_per_model = 20, .finalists_per_model = 5};
    const auto refined =
        refine_hypotheses(scan, probe(kCorner), guesses(scene, kCorner, 1.5, 20.0, 80), settings);
    ASSERT_FALSE(refined.empty());
    EXPECT_LE(refined.size(), 5U);
    for (std::size_t i = 0; i < refined.size(); ++i) {
        const Evidence evidence =
            gather_evidence(scan, probe(kCorner), refined[i].T_scene_model, tolerance());
        EXPECT_DOUBLE_EQ(refined[i].score, quick_score(evidence));
        for (std::size_t j = 0; j < i; ++j) {
            EXPECT_GE(refined[j].score, refined[i].score);
            const Pose turn = refined[i].T_scene_model.inverse() * refined[j].T_scene_model;
            const Vec3d& center = models().shapes[kCorner].center;
            const double apart =
                (turn * center - center).norm() +
                models().shapes[kCorner].radius * Eigen::AngleAxisd(turn.linear()).angle();
            EXPECT_GT(apart, 0.99 * scan.sampling);
        }
    }
}

TEST(RefineHypotheses, NothingFromNothing) {
    EXPECT_TRUE(refine_hypotheses(prepared(alone(kCorner, 0)), probe(kCorner), {}, {}).empty());
}

TEST(RefineHypotheses, AreTheSameForAnyNumberOfThreads) {
    const SimulatedScene scene = alone(kPlate, 1);
    const Scan scan = prepared(scene);
    set_thread_count(1);
    const auto one =
        refine_hypotheses(scan, probe(kPlate), guesses(scene, kPlate, 0.4, 10.0, 50), {});
    set_thread_count(4);
    const auto four =
        refine_hypotheses(scan, probe(kPlate), guesses(scene, kPlate, 0.4, 10.0, 50), {});
    set_thread_count(0);
    ASSERT_EQ(one.size(), four.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].T_scene_model.matrix(), four[i].T_scene_model.matrix());
        EXPECT_EQ(one[i].score, four[i].score);
    }
}

}  // namespace
}  // namespace ostraka
