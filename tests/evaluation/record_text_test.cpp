// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/record_text.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "evaluation/evaluation_testing.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

using namespace evaluation_testing;

Pose random_pose(Random& random) {
    Pose pose = shifted(random.normal() * 1e3, random.normal() * 1e-9, 1.0 / 3.0);
    pose.linear() = random.rotation();
    return pose;
}

// Numbers without a short decimal form in every field.
SceneRecord random_record(std::uint64_t seed) {
    Random random(seed);
    SceneRecord record{.name = "000001/\"näme\"\t\\", .scene = 3, .image = 1'000'000};
    record.image_width = 640;
    for (std::uint32_t i = 0; i < 4; ++i) {
        record.truth.push_back(
            {i % 2, random_pose(random), random.uniform(), random.below(1000), 12345678901ULL});
        record.clutter.push_back(random.uniform());
        record.reports.push_back({.model = i % 2 == 0 ? "a" : "b",
                                  .model_index = i % 2,
                                  .T_scene_model = random_pose(random),
                                  .confidence = random.uniform(),
                                  .visible_fraction = random.uniform(),
                                  .inlier_rms = random.uniform(),
                                  .source = i < 2 ? "segment" : "keypoints"});
        PosePair pair{i, 3 - i, random.uniform(), random.uniform(), -1.0, random.uniform(), {}};
        if (i == 1) pair.mspd = 12.0 * random.uniform();
        // A point at or behind the camera has no place in the image.
        if (i == 2) pair.mspd = std::numeric_limits<double>::infinity();
        if (i > 1) pair.vsd = {0.0, 1.0, random.uniform()};
        record.pairs.push_back(pair);
    }
    record.seconds = {{"all", random.uniform()}, {"segments", 1e-9}};
    return record;
}

void expect_same(const SceneRecord& a, const SceneRecord& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.scene, b.scene);
    EXPECT_EQ(a.image, b.image);
    EXPECT_EQ(a.clutter, b.clutter);
    EXPECT_EQ(a.seconds, b.seconds);
    EXPECT_EQ(a.image_width, b.image_width);
    ASSERT_EQ(a.truth.size(), b.truth.size());
    for (std::size_t i = 0; i < a.truth.size(); ++i) {
        EXPECT_EQ(a.truth[i].model, b.truth[i].model);
        EXPECT_EQ(a.truth[i].T_scene_model.matrix(), b.truth[i].T_scene_model.matrix());
        EXPECT_EQ(a.truth[i].visible_fraction, b.truth[i].visible_fraction);
        EXPECT_EQ(a.truth[i].pixels_visible, b.truth[i].pixels_visible);
        EXPECT_EQ(a.truth[i].pixels_total, b.truth[i].pixels_total);
    }
    ASSERT_EQ(a.reports.size(), b.reports.size());
    for (std::size_t i = 0; i < a.reports.size(); ++i) {
        EXPECT_EQ(a.reports[i].model, b.reports[i].model);
        EXPECT_EQ(a.reports[i].model_index, b.reports[i].model_index);
        EXPECT_EQ(a.reports[i].T_scene_model.matrix(), b.reports[i].T_scene_model.matrix());
        EXPECT_EQ(a.reports[i].confidence, b.reports[i].confidence);
        EXPECT_EQ(a.reports[i].visible_fraction, b.reports[i].visible_fraction);
        EXPECT_EQ(a.reports[i].inlier_rms, b.reports[i].inlier_rms);
        EXPECT_EQ(a.reports[i].source, b.reports[i].source);
    }
    ASSERT_EQ(a.pairs.size(), b.pairs.size());
    for (std::size_t i = 0; i < a.pairs.size(); ++i) {
        EXPECT_EQ(a.pairs[i].report, b.pairs[i].report);
        EXPECT_EQ(a.pairs[i].truth, b.pairs[i].truth);
        EXPECT_EQ(a.pairs[i].adi, b.pairs[i].adi);
        EXPECT_EQ(a.pairs[i].mssd, b.pairs[i].mssd);
        EXPECT_EQ(a.pairs[i].mspd, b.pairs[i].mspd);
        EXPECT_EQ(a.pairs[i].degrees, b.pairs[i].degrees);
        EXPECT_EQ(a.pairs[i].vsd, b.pairs[i].vsd);
    }
}

TEST(RecordText, ARecordComesBackExactly) {
    const ModelLibrary library = two_models();
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const SceneRecord record = random_record(seed);
        const std::string text = to_text(record);
        EXPECT_EQ(text.find('\n'), std::string::npos);  // a journal keeps one line an item
        const SceneRecord back = scene_record_from_text(text, library);
        expect_same(record, back);
        EXPECT_EQ(to_text(back), text);
    }
    expect_same(scene_record_from_text(to_text(SceneRecord{}), library), SceneRecord{});
}

TEST(RecordText, TrialsComeBackExactly) {
    Random random(1);
    std::vector<std::vector<SegmentTrial>> trials(2);
    for (std::size_t i = 0; i < 5; ++i) {
        trials[i % 2].push_back(
            {i, random.below(9), random.uniform(), {{"shot", {1, kNoIndex}}, {"fused", {0, 2}}}});
    }
    const auto back = segment_trials_from_text(to_text(trials));
    ASSERT_EQ(back.size(), 2U);
    for (std::size_t l = 0; l < 2; ++l) {
        ASSERT_EQ(back[l].size(), trials[l].size());
        for (std::size_t i = 0; i < back[l].size(); ++i) {
            EXPECT_EQ(back[l][i].scene, trials[l][i].scene);
            EXPECT_EQ(back[l][i].model, trials[l][i].model);
            EXPECT_EQ(back[l][i].visible_fraction, trials[l][i].visible_fraction);
            EXPECT_EQ(back[l][i].answers, trials[l][i].answers);
        }
    }
    // Scenes without segments still have a list for each library.
    EXPECT_EQ(segment_trials_from_text(to_text(std::vector<std::vector<SegmentTrial>>(3))).size(),
              3U);
}

// Whatever is read, it is read or InvalidInput is thrown: another exception fails the test.
template <class Read>
bool survives(const Read& read, const std::string& text) {
    try {
        read(text);
        return true;
    } catch (const InvalidInput&) {
        return false;
    }
}

template <class Read>
void expect_damage_is_invalid_input(const Read& read, const std::string& text) {
    ASSERT_TRUE(survives(read, text));
    for (std::size_t length = 0; length < text.size(); ++length) {
        ASSERT_FALSE(survives(read, text.substr(0, length))) << length;
    }
    Random random(5);
    int refused = 0;
    for (int i = 0; i < 3000; ++i) {
        std::string damaged = text;
        damaged[random.below(static_cast<std::uint32_t>(text.size()))] =
            static_cast<char>(random.below(256));
        refused += survives(read, damaged) ? 0 : 1;
    }
    EXPECT_GT(refused, 500);
}

TEST(RecordText, DamagedTextIsInvalidInput) {
    const ModelLibrary library = two_models();
    const auto record = [&](const std::string& text) {
        return scene_record_from_text(text, library);
    };
    const auto trials = [](const std::string& text) { return segment_trials_from_text(text); };
    expect_damage_is_invalid_input(record, to_text(random_record(1)));
    expect_damage_is_invalid_input(
        trials, to_text(std::vector<std::vector<SegmentTrial>>{
                    {{3, 1, 0.4, {{"shot", {1, 0}}}}, {4, 0, 0.5, {{"shot", {1, 1}}}}}}));
    for (const char* text : {"", "null", "5", "\"x\"", "[]", "{}"}) {
        EXPECT_FALSE(survives(record, text)) << text;
    }
    for (const char* text : {"", "5", "\"x\"", "[[5]]", "[[{}]]"}) {
        EXPECT_FALSE(survives(trials, text)) << text;
    }
}

TEST(RecordText, IndicesBeyondWhatIsThereAreInvalidInput) {
    const ModelLibrary library = two_models();
    const SceneRecord good = random_record(2);
    SceneRecord bad = good;
    bad.truth[1].model = 2;
    EXPECT_THROW(scene_record_from_text(to_text(bad), library), InvalidInput);
    bad = good;
    bad.reports[1].model_index = kNoIndex;
    EXPECT_THROW(scene_record_from_text(to_text(bad), library), InvalidInput);
    bad = good;
    bad.pairs[0].report = 4;
    EXPECT_THROW(scene_record_from_text(to_text(bad), library), InvalidInput);
    bad = good;
    bad.pairs[0].truth = 4;
    EXPECT_THROW(scene_record_from_text(to_text(bad), library), InvalidInput);
    bad = good;
    bad.clutter.pop_back();
    EXPECT_THROW(scene_record_from_text(to_text(bad), library), InvalidInput);
}

}  // namespace
}  // namespace ostraka
