// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/scenes.hpp"

#include <gtest/gtest.h>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

// Two models of diameter 10; poses differ by shifts only.
ModelLibrary two_models() {
    ModelLibrary library;
    Random random(2);
    for (const char* name : {"a", "b"}) {
        Model model;
        model.name = name;
        model.shape.diameter = 10.0;
        for (int i = 0; i < 300; ++i) {
            model.surface.points.push_back(
                Vec3d(5.0 * random.uniform() * random.direction()).cast<float>());
        }
        library.models.push_back(model);
    }
    return library;
}

Pose shifted(double x) {
    Pose pose = Pose::Identity();
    pose.translation() = Vec3d(x, 0.0, 0.0);
    return pose;
}

RecognizedObject report_at(std::uint32_t model, double x) {
    return {.model_index = model, .T_scene_model = shifted(x), .confidence = 0.9};
}

TEST(MatchOutcome, CountsHitsMissesAndWrongReports) {
    const ModelLibrary library = two_models();
    const std::vector<TrueObject> truth = {
        {0, shifted(0.0), 0.9}, {1, shifted(50.0), 0.5}, {0, shifted(100.0), 0.8}};
    Recognition recognition;
    recognition.objects = {report_at(0, 0.01), report_at(0, 50.0), report_at(1, 500.0)};
    const SceneOutcome outcome = match_outcome(recognition, truth, library);
    ASSERT_EQ(outcome.hits.size(), 1U);
    EXPECT_LE(outcome.hits[0].adi, 0.0011);
    EXPECT_EQ(outcome.misses.size(), 2U);
    EXPECT_EQ(outcome.wrong.size(), 2U);
}

TEST(MatchOutcome, ATrueObjectIsHitOnce) {
    const std::vector<TrueObject> truth = {{0, shifted(0.0), 0.9}};
    Recognition recognition;
    recognition.objects = {report_at(0, 0.2), report_at(0, 0.0)};
    const SceneOutcome outcome = match_outcome(recognition, truth, two_models());
    ASSERT_EQ(outcome.hits.size(), 1U);
    EXPECT_NEAR(outcome.hits[0].adi, 0.0, 1e-9);  // the nearer of the two
    EXPECT_EQ(outcome.wrong.size(), 1U);
}

TEST(MatchOutcome, HardlyVisibleObjectsAreNeitherHitNorMiss) {
    const std::vector<TrueObject> truth = {{0, shifted(0.0), 0.14}, {1, shifted(50.0), 0.1}};
    Recognition recognition;
    recognition.objects = {report_at(0, 0.0)};
    const SceneOutcome outcome = match_outcome(recognition, truth, two_models());
    EXPECT_TRUE(outcome.hits.empty());
    EXPECT_TRUE(outcome.misses.empty());
    EXPECT_TRUE(outcome.wrong.empty());
}

TEST(Summarize, AddsUp) {
    SceneOutcome one;
    one.hits = {{0, 0.9, 0.9, 0.01}, {0, 0.9, 0.9, 0.03}, {0, 0.9, 0.9, 0.02}};
    SceneOutcome two;
    two.misses = {{1, 0.5, 0.0, -1.0}};
    two.wrong = {{1, 0.0, 0.6, -1.0}};
    const SceneSummary summary = summarize(std::vector<SceneOutcome>{one, two});
    EXPECT_EQ(summary.objects, 4U);
    EXPECT_DOUBLE_EQ(summary.recall, 0.75);
    EXPECT_DOUBLE_EQ(summary.precision, 0.75);
    EXPECT_DOUBLE_EQ(summary.median_adi, 0.02);
    EXPECT_DOUBLE_EQ(summarize({}).precision, 1.0);
}

}  // namespace
}  // namespace ostraka
