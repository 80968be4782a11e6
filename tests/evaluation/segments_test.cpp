// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/segments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "evaluation/evaluation_testing.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/evaluation/run.hpp"

namespace ostraka {
namespace {

using namespace evaluation_testing;

TEST(SegmentsOf, HoldThePointsOfWhatIsAsVisibleAsAskedFor) {
    TestScene scene;
    scene.objects = {truth_at(1, 0.0, 0.5), truth_at(0, 0.0, 0.09), truth_at(0, 0.0, 0.9),
                     truth_at(0, 0.0, 0.85)};
    scene.cloud.viewpoint = Vec3f(1, 2, 3);
    for (int i = 0; i < 8; ++i) scene.cloud.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    scene.labels = {0, 1, kNoIndex, 2, 0, 3, 3, kNoIndex};
    const std::vector<LabeledSegment> segments = segments_of(scene, 7, {});
    ASSERT_EQ(segments.size(), 2U);
    EXPECT_EQ(segments[0].model, 1U);
    EXPECT_EQ(segments[0].visible_fraction, 0.5);
    EXPECT_EQ(segments[0].scene, 7U);
    EXPECT_EQ(segments[0].cloud.viewpoint, Vec3f(1, 2, 3));
    ASSERT_EQ(segments[0].cloud.size(), 2U);
    EXPECT_EQ(segments[0].cloud.points[1], Vec3f(4, 0, 0));
    EXPECT_EQ(segments[1].visible_fraction, 0.85);  // both limits are meant inclusively
    EXPECT_EQ(segments_of(scene, 0, {.min_visible = 0.09, .max_visible = 1.0}).size(), 4U);
}

TEST(SegmentsOf, SimulatedScenesGiveClouds) {
    RandomViewSettings recipe;
    recipe.camera = small_camera();
    const TestSet set = simulated_set(small_library(), recipe, 6);
    std::size_t count = 0;
    for (std::size_t i = 0; i < set.count; ++i) {
        for (const LabeledSegment& segment : segments_of(set.load(i), i, {})) {
            ++count;
            EXPECT_GE(segment.visible_fraction, 0.10);
            EXPECT_LE(segment.visible_fraction, 0.85);
            EXPECT_LT(segment.model, 2U);
            EXPECT_FALSE(segment.cloud.empty());
            for (const Vec3f& point : segment.cloud.points) ASSERT_TRUE(point.allFinite());
        }
    }
    EXPECT_GT(count, 3U);
}

TEST(TrySegment, EveryMethodNamesAWholeModel) {
    const ModelLibrary& library = small_library();
    const EntryIndex index(library);
    const std::vector<std::string> methods = methods_of(library);
    ASSERT_EQ(methods.size(), library.tables.size() + 2);  // no codebook was asked for
    const std::vector<std::size_t> ks = {1, 5};
    for (std::uint32_t m = 0; m < 2; ++m) {
        // What an entry shows, seen from where it was seen.
        const auto entry = std::find_if(library.entries.begin(), library.entries.end(),
                                        [&](const Entry& e) { return e.model == m; });
        ASSERT_NE(entry, library.entries.end());
        const LabeledSegment segment{m, 0.5, entry->cloud, 4};
        const SegmentTrial trial = try_segment(index, segment, ks);
        EXPECT_EQ(trial.scene, 4U);
        EXPECT_EQ(trial.model, m);
        EXPECT_EQ(trial.answers.size(), methods.size());
        for (const std::string& method : methods) {
            ASSERT_EQ(trial.answers.at(method).size(), 2U) << method;
            for (const std::uint32_t answer : trial.answers.at(method)) EXPECT_LT(answer, 2U);
        }
        EXPECT_TRUE(trial.right("fused", 0));
    }
}

TEST(TrySegment, AScrapHasNoAnswer) {
    LabeledSegment scrap{1, 0.1, {}, 0};
    for (int i = 0; i < 4; ++i) scrap.cloud.points.emplace_back(static_cast<float>(i), 0.0F, 50.0F);
    const SegmentTrial trial = try_segment(EntryIndex(small_library()), scrap, std::vector{1UL});
    for (const auto& [method, answers] : trial.answers) {
        EXPECT_EQ(answers, std::vector<std::uint32_t>{kNoIndex}) << method;
        EXPECT_FALSE(trial.right(method, 0));
    }
}

SegmentTrial trial_of(std::size_t scene, std::uint32_t model, std::uint32_t answer,
                      std::uint32_t at_k5) {
    return {scene, model, 0.5, {{"shot", {answer, at_k5}}}};
}

// Right at k = 1: three of four; at k = 5: one.
const std::vector<SegmentTrial> kTrials = {trial_of(0, 0, 0, 1), trial_of(0, 1, 1, 1),
                                           trial_of(1, 1, 0, kNoIndex), trial_of(2, 1, 1, 0)};

TEST(RecognitionRate, IsTheShareOfRightAnswers) {
    EXPECT_DOUBLE_EQ(recognition_rate(kTrials, "shot", 0).value, 0.75);
    EXPECT_DOUBLE_EQ(recognition_rate(kTrials, "shot", 1).value, 0.25);
    // Scenes are drawn, not segments: three times scene 1 has a rate of 0.
    EXPECT_DOUBLE_EQ(recognition_rate(kTrials, "shot", 0).low, 0.0);
    EXPECT_DOUBLE_EQ(recognition_rate({}, "shot", 0).value, 0.0);
}

TEST(RecognitionGain, IsTheDifferenceOnTheSameSegmentsOnly) {
    std::vector<SegmentTrial> baseline = kTrials;
    baseline[0].answers["shot"] = {1, 1};
    baseline[1].answers["shot"] = {0, 0};
    EXPECT_DOUBLE_EQ(recognition_gain(kTrials, baseline, "shot", 0).value, 0.5);
    EXPECT_DOUBLE_EQ(recognition_gain(baseline, kTrials, "shot", 0).value, -0.5);
    EXPECT_DOUBLE_EQ(recognition_gain(kTrials, kTrials, "shot", 0).high, 0.0);
    std::vector<SegmentTrial> other = baseline;
    other[2].visible_fraction = 0.6;
    EXPECT_THROW(recognition_gain(kTrials, other, "shot", 0), InvalidInput);
    other = baseline;
    other[2].model = 0;
    EXPECT_THROW(recognition_gain(kTrials, other, "shot", 0), InvalidInput);
    other = baseline;
    other[2].scene = 5;
    EXPECT_THROW(recognition_gain(kTrials, other, "shot", 0), InvalidInput);
    other = baseline;
    other.pop_back();
    EXPECT_THROW(recognition_gain(kTrials, other, "shot", 0), InvalidInput);
}

TEST(SegmentConfusion, CountsAnswersAndNone) {
    // Rows: true model; columns: a, b, none.
    EXPECT_EQ(confusion_matrix(kTrials, "shot", 0, 2), (std::vector<double>{1, 0, 0, 1, 2, 0}));
    EXPECT_EQ(confusion_matrix(kTrials, "shot", 1, 2), (std::vector<double>{0, 1, 0, 1, 1, 1}));
}

// The study's effect (issue "the main job", point 4): on occluded segments of the six Bologna
// models, subparts beat full views for every descriptor at k = 1. See BENCHMARK.md for the table.
TEST(Segments, SubpartsBeatFullViewsOnBologna) {
    const char* data = std::getenv("OSTRAKA_DATA");
    if (data == nullptr || !std::filesystem::exists(std::string(data) + "/bologna/models")) {
        GTEST_SKIP() << "needs the Bologna models: set OSTRAKA_DATA to the folder that holds "
                        "bologna/models/*.ply (Stanford's scanned models, research use)";
    }
    std::vector<ModelSource> models;
    for (const char* name :
         {"armadillo", "asian_dragon", "buddha", "bunny", "dragon", "thai_statue"}) {
        models.push_back(load_model(std::string(data) + "/bologna/models/" + name + ".ply"));
    }
    LibrarySettings settings;
    settings.unit = Unit::meter;
    const ModelLibrary subparts = build_library(models, settings);
    settings.full_views_only = true;
    const ModelLibrary views = build_library(models, settings);
    const EntryIndex of_subparts(subparts);
    const EntryIndex of_views(views);
    RandomViewSettings recipe;
    recipe.seed = 5;
    const TestSet set = simulated_set(subparts, recipe, 80);
    const std::vector<const EntryIndex*> indices = {&of_views, &of_subparts};
    Journal none("", "");
    const auto trials = run_segments(indices, set, {}, none);
    ASSERT_EQ(trials.size(), 2U);
    ASSERT_GT(trials[0].size(), 150U);
    const auto rate = [&](std::size_t library, const std::string& method) {
        return recognition_rate(trials[library], method, 0).value;
    };
    for (const char* name : {"vfh", "esf", "gasd", "shot", "rops"}) {
        EXPECT_GT(rate(1, name), rate(0, name)) << name;
        EXPECT_NEAR(recognition_gain(trials[1], trials[0], name, 0).value,
                    rate(1, name) - rate(0, name), 1e-12);
        RecordProperty(name,
                       std::to_string(rate(0, name)) + " -> " + std::to_string(rate(1, name)));
    }
    // Keypoints, and with them the fused ranking, hardly depend on the entries: both are near 1.
    EXPECT_GT(rate(1, "keypoints"), 0.9);
    EXPECT_GT(rate(1, "fused"), 0.9);
    EXPECT_GT(rate(1, "fused"), rate(1, "shot") + 0.2);
}

}  // namespace
}  // namespace ostraka
