// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/explanation.hpp"

#include <cmath>

#include "ostraka/recognition/confidence.hpp"
#include "ostraka/recognition/verdict_picture.hpp"
#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

// A scan of one corner in front of nothing, and what is made of poses of it.
struct Case {
    SimulatedScene scene = alone(kCorner, 3);
    Scan scan = prepare_scan(library(), scene.cloud, {});
    Recognition recognition{.judge = general_confidence()};

    RecognizedObject judged(const Pose& T_scene_model) const {
        Verified verified = verify(scan, probe(kCorner),
                                   {.model = kCorner, .T_scene_model = T_scene_model}, tolerance());
        const Features features = features_of(verified);
        return {.model = library().models[kCorner].name,
                .model_index = kCorner,
                .T_scene_model = T_scene_model,
                .confidence = too_small(verified) ? 0.0 : general_confidence().confidence(features),
                .visible_fraction = verified.visible_fraction,
                .source = "segment",
                .features = features};
    }
    void report(const Pose& T_scene_model) {
        recognition.objects.push_back(judged(T_scene_model));
        add(T_scene_model, 0);
    }
    void add(const Pose& T_scene_model, std::uint32_t lost_to) {
        recognition.candidates.push_back(judged(T_scene_model));
        recognition.lost_to.push_back(lost_to);
    }
    std::vector<Explanation> explained() const {
        return explain(library(), recognition, scan, {}, {.unit = "mm"});
    }
    const Pose& truth() const { return scene.objects.front().T_scene_model; }
    Pose moved(const Vec3d& shift) const { return Eigen::Translation3d(shift) * truth(); }
    Vec3d toward_sensor() const {
        const Vec3d center = truth() * library().models[kCorner].shape.center;
        return (scene.cloud.viewpoint.cast<double>() - center).normalized();
    }
};

bool says(const Explanation& one, const std::string& words) {
    return one.verdict.find(words) != std::string::npos;
}

TEST(Explanation, OfATrueObjectSaysWhatConfirmsIt) {
    Case test;
    test.report(test.truth());
    const auto explained = test.explained();
    ASSERT_EQ(explained.size(), 1U);
    const Explanation& one = explained.front();
    EXPECT_EQ(one.outcome, Outcome::reported);
    EXPECT_EQ(one.number, 0U);
    EXPECT_TRUE(says(one, "Reported")) << one.verdict;
    EXPECT_TRUE(says(one, "of what should be seen")) << one.verdict;
    EXPECT_FALSE(one.reasons.empty());
}

TEST(Explanation, OfATwinNamesTheObjectItLostTo) {
    Case test;
    const double diameter = library().models[kCorner].shape.diameter;
    test.report(test.truth());
    test.add(test.moved(0.1 * diameter * Vec3d::UnitX()), 0);
    test.recognition.candidates.back().confidence = 0.97;  // enough to be reported
    const auto explained = test.explained();
    ASSERT_EQ(explained.size(), 2U);
    EXPECT_EQ(explained[1].outcome, Outcome::lost);
    EXPECT_EQ(explained[1].rival, 0U);
    const std::string rival = test.recognition.objects[0].model + " #1";
    EXPECT_TRUE(says(explained[1], "explained better by " + rival)) << explained[1].verdict;
}

TEST(Explanation, NamesTheModelThatExplainsTheSameAsWell) {
    Case test;
    test.report(test.truth());
    RecognizedObject& object = test.recognition.objects.front();
    object.rival = "bracket";
    object.features[static_cast<std::size_t>(Feature::rival)] = std::log(5.0);
    object.confidence = 0.5;
    const Explanation one = test.explained().front();
    // Odds of 5, 4 and 1: the object, its rival, neither.
    const std::size_t against = one.verdict.find("Against it:");
    ASSERT_NE(against, std::string::npos) << one.verdict;
    EXPECT_NE(one.verdict.find("bracket explains the same nearly as well: it is that with a "
                               "probability of 40 %",
                               against),
              std::string::npos)
        << one.verdict;
    // Odds of 18, 1 and 1.
    object.features[static_cast<std::size_t>(Feature::rival)] = std::log(2.0);
    object.confidence = 0.9;
    const std::string verdict = test.explained().front().verdict;
    EXPECT_NE(verdict.find("less well: it is that with a probability of 5 %"), std::string::npos)
        << verdict;
}

TEST(Explanation, OfWhatFloatsInFrontOfTheScanSaysThatItIsContradicted) {
    Case test;
    // Half of the way out of the surface: some of it still fits, the sensor saw through the rest.
    const double diameter = library().models[kCorner].shape.diameter;
    test.add(test.moved(0.3 * diameter * test.toward_sensor()), kNoIndex);
    const auto explained = test.explained();
    ASSERT_EQ(explained.size(), 1U);
    const Explanation& one = explained.front();
    EXPECT_TRUE(one.outcome == Outcome::doubtful || one.outcome == Outcome::too_small);
    EXPECT_GT(one.verified.violation, one.verified.support);
    EXPECT_TRUE(says(one, "inside one piece: the sensor looked through it there")) << one.verdict;
    EXPECT_TRUE(says(one, "Not reported")) << one.verdict;
}

TEST(Explanation, ListsEachPlaceOnceAndNoMoreThanAsked) {
    Case test;
    const double diameter = library().models[kCorner].shape.diameter;
    test.report(test.truth());
    for (int i = 0; i < 6; ++i) {
        test.add(test.moved((i % 3) * diameter * Vec3d::UnitX()), kNoIndex);
    }
    EXPECT_EQ(test.explained().size(), 3U);  // itself and two other places
    const auto few =
        explain(library(), test.recognition, test.scan, {}, {.near_misses = 1, .unit = "mm"});
    EXPECT_EQ(few.size(), 2U);
}

TEST(Explanation, EffectsAddUpToTheConfidence) {
    Case test;
    test.report(test.truth());
    const Explanation one = test.explained().front();
    Features typical{};
    for (std::size_t i = 0; i < kFeatures; ++i) {
        typical[i] = typical_value(static_cast<Feature>(i));
    }
    const double base = general_confidence().confidence(typical);
    double logit = std::log(base / (1.0 - base));
    for (const Reason& reason : one.reasons) logit += reason.contribution;
    EXPECT_NEAR(1.0 / (1.0 + std::exp(-logit)), one.object.confidence, 1e-9);
}

TEST(Explanation, PictureShowsConfirmedCellsInTheirColor) {
    Case test;
    test.report(test.truth());
    const auto explained = test.explained();
    const VerdictPicture picture =
        draw_verdicts(test.scene.cloud, library(), test.scan, explained).front();
    ASSERT_EQ(picture.verdicts.pixels.size(), picture.scan.pixels.size());
    std::size_t green = 0;
    for (const Color& color : picture.verdicts.pixels) {
        green += color[1] > color[0] + 20 && color[1] > color[2] + 20 ? 1 : 0;
    }
    EXPECT_GT(green, picture.verdicts.pixels.size() / 20);
}

TEST(Explanation, RecognitionTellsWhatEachCandidateLostTo) {
    const SimulatedScene scene = tabletop({kCorner}, 1);
    const Recognition result = recognize(library(), scene.cloud, {.keep_candidates = true});
    ASSERT_EQ(result.lost_to.size(), result.candidates.size());
    ASSERT_EQ(result.objects.size(), 1U);
    std::size_t itself = 0;
    for (std::size_t i = 0; i < result.candidates.size(); ++i) {
        if (result.candidates[i].confidence >= 0.5) {
            EXPECT_EQ(result.lost_to[i], 0U);
        }
        const bool same =
            result.candidates[i].T_scene_model.matrix() == result.objects[0].T_scene_model.matrix();
        itself += same && result.lost_to[i] == 0 ? 1 : 0;
    }
    EXPECT_GE(itself, 1U);
}

}  // namespace
}  // namespace ostraka
