// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/evaluation_testing.hpp"

namespace ostraka {
namespace {

// The confidences below are made up around one half.
const MatchSettings kFromHalf{.min_confidence = 0.5};

using namespace evaluation_testing;

TEST(Match, CountsHitsMissesAndWrongReports) {
    const ModelLibrary library = two_models();
    const SceneRecord record = record_for(
        library, {truth_at(0, 0.0, 0.9), truth_at(1, 50.0, 0.5), truth_at(0, 100.0, 0.8)},
        {report_at(0, 0.01), report_at(0, 50.0), report_at(1, 500.0)});
    const Matching matching = match(record, library, kFromHalf);
    ASSERT_EQ(matching.hits.size(), 1U);
    EXPECT_EQ(matching.hits[0].truth, 0U);
    EXPECT_LE(matching.hits[0].adi, 0.0011);
    EXPECT_EQ(matching.misses, (std::vector<std::uint32_t>{1, 2}));
    EXPECT_EQ(matching.wrong, (std::vector<std::uint32_t>{1, 2}));
    // Report 1, an "a" where the "b" is, was made in its place; nothing was where the last is.
    EXPECT_EQ(matching.instead, (std::vector<std::uint32_t>{1, kNoIndex}));
}

TEST(Match, ATrueObjectIsHitOnce) {
    const ModelLibrary library = two_models();
    const SceneRecord record = record_for(library, {truth_at(0, 0.0, 0.9)},
                                          {report_at(0, 0.2, 0.95), report_at(0, 0.0, 0.6)});
    const Matching matching = match(record, library, kFromHalf);
    ASSERT_EQ(matching.hits.size(), 1U);
    EXPECT_NEAR(matching.hits[0].adi, 0.0, 1e-9);  // the nearer of the two
    EXPECT_EQ(record.reports[matching.hits[0].report].confidence, 0.6);
    EXPECT_EQ(matching.wrong.size(), 1U);
    EXPECT_TRUE(matching.misses.empty());
}

TEST(Match, HardlyVisibleObjectsAreNeitherHitNorMiss) {
    const ModelLibrary library = two_models();
    const SceneRecord record =
        record_for(library, {truth_at(0, 0.0, 0.14), truth_at(1, 50.0, 0.1)}, {report_at(0, 0.0)});
    const Matching matching = match(record, library, kFromHalf);
    EXPECT_TRUE(matching.hits.empty());
    EXPECT_TRUE(matching.misses.empty());
    EXPECT_TRUE(matching.wrong.empty());
    EXPECT_EQ(match(record, library, {.min_visible = 0.1, .min_confidence = 0.5}).hits.size(), 1U);
    EXPECT_EQ(match(record, library, {.min_visible = 0.1, .min_confidence = 0.5}).misses.size(),
              1U);
}

TEST(Match, ReportsOfLittleConfidenceAreIgnored) {
    const ModelLibrary library = two_models();
    const SceneRecord record = record_for(library, {truth_at(0, 0.0, 0.9)},
                                          {report_at(0, 0.0, 0.3), report_at(1, 70.0, 0.2)});
    const Matching strict = match(record, library, kFromHalf);
    EXPECT_TRUE(strict.hits.empty());
    EXPECT_TRUE(strict.wrong.empty());
    EXPECT_EQ(strict.misses.size(), 1U);
    const Matching lenient = match(record, library, {.min_confidence = 0.25});
    EXPECT_EQ(lenient.hits.size(), 1U);
    EXPECT_TRUE(lenient.wrong.empty());
}

TEST(Match, APoseThatIsTooFarOffIsWrong) {
    const ModelLibrary library = two_models();
    const SceneRecord record = record_for(library, {truth_at(0, 0.0, 0.9)}, {report_at(0, 4.0)});
    ASSERT_EQ(record.pairs.size(), 1U);
    const double adi = record.pairs[0].adi;
    EXPECT_EQ(match(record, library, {.max_adi = 0.99 * adi, .min_confidence = 0.5}).wrong.size(),
              1U);
    EXPECT_EQ(match(record, library, {.max_adi = 1.01 * adi, .min_confidence = 0.5}).hits.size(),
              1U);
}

TEST(PoseJudge, MeasuresWhatIsNearby) {
    const ModelLibrary library = two_models();
    TestScene scene;
    scene.camera = PinholeCamera{};
    TrueObject truth = truth_at(0, 0.0, 1.0);
    truth.T_scene_model = shifted(0.0, 0.0, 100.0);
    scene.objects = {truth};
    RecognizedObject near = report_at(0, 0.0, 0.2);
    near.T_scene_model = shifted(3.0, 0.0, 100.0);
    RecognizedObject far = report_at(0, 0.0, 0.9);
    far.T_scene_model = shifted(10.5, 0.0, 100.0);  // a diameter is 10
    RecognizedObject other = near;
    other.model_index = 1;
    const SceneRecord record = record_of(PoseJudge(library, false), scene, {near, far, other}, {});
    EXPECT_EQ(record.image_width, 640);
    EXPECT_EQ(record.reports[0].confidence, 0.9);  // most confident first
    ASSERT_EQ(record.pairs.size(), 1U);
    const PosePair& pair = record.pairs[0];
    EXPECT_EQ(record.reports[pair.report].T_scene_model.translation().x(), 3.0);
    EXPECT_NEAR(pair.mssd, 0.3, 1e-12);
    EXPECT_LT(pair.adi, 0.3);
    EXPECT_GT(pair.adi, 0.03);
    EXPECT_NEAR(pair.degrees, 0.0, 1e-6);
    double nearest = 1e9;  // the point nearest to the camera moves most in the image
    for (const Vec3f& point : library.models[0].mesh.vertices) {
        nearest = std::min(nearest, 100.0 + double{point.z()});
    }
    EXPECT_NEAR(pair.mspd, 575.0 * 3.0 / nearest, 1e-9);
    EXPECT_TRUE(pair.vsd.empty());
}

TEST(Record, ClutterIsTheShareOfThePointsThatAreNotTheObjects) {
    const ModelLibrary library = two_models();
    TestScene scene;
    scene.objects = {truth_at(0, 0.0, 1.0), truth_at(1, 30.0, 1.0)};
    scene.cloud.points.assign(10, Vec3f::Zero());
    scene.labels = {0, 0, 0, 0, 1, kNoIndex, kNoIndex, kNoIndex, 1, 1};
    // No return: of no object.
    scene.cloud.points[8].setConstant(std::nanf(""));
    scene.cloud.points[9].setConstant(std::nanf(""));
    const SceneRecord record = record_of(PoseJudge(library, false), scene, {}, {});
    ASSERT_EQ(record.clutter.size(), 2U);
    EXPECT_DOUBLE_EQ(record.clutter[0], 0.5);
    EXPECT_DOUBLE_EQ(record.clutter[1], 7.0 / 8.0);
    EXPECT_EQ(record.image_width, 0);
}

// Two scenes: three hits at 0, 0.1 and 0.2 in the first; a miss with a wrong report in the second.
std::vector<SceneRecord> two_scenes(const ModelLibrary& library) {
    std::vector<SceneRecord> records = {
        record_for(library,
                   {truth_at(0, 0.0, 0.95), truth_at(1, 50.0, 0.55), truth_at(0, 100.0, 0.85)},
                   {report_at(0, 0.0, 0.95), report_at(1, 50.1, 0.85), report_at(0, 100.2, 0.55)}),
        record_for(library, {truth_at(1, 0.0, 0.35), truth_at(1, 200.0, 0.05)},
                   {report_at(0, 1.0, 0.65), report_at(1, 300.0, 0.05)})};
    records[0].clutter = {0.05, 0.45, 0.5};
    records[1].clutter = {1.0, 0.9};
    records[0].seconds = {{"all", 1.0}, {"segments", 0.5}};
    records[1].seconds = {{"all", 3.0}};
    return records;
}

TEST(Summarize, AddsUp) {
    const ModelLibrary library = two_models();
    const std::vector<SceneRecord> records = two_scenes(library);
    const SceneSummary summary = summarize(records, library, kFromHalf);
    EXPECT_EQ(summary.objects, 4U);
    EXPECT_EQ(summary.hits, 3U);
    EXPECT_EQ(summary.wrong, 1U);
    EXPECT_DOUBLE_EQ(summary.recall.value, 0.75);
    EXPECT_DOUBLE_EQ(summary.precision.value, 0.75);
    // All hits are of one scene: a draw without it has none.
    EXPECT_DOUBLE_EQ(summary.recall.low, 0.0);
    EXPECT_DOUBLE_EQ(summary.recall.high, 1.0);
    EXPECT_DOUBLE_EQ(summary.median_adi.value, match(records[0], library, kFromHalf).hits[1].adi);
    EXPECT_DOUBLE_EQ(summary.seconds, 2.0);
    EXPECT_DOUBLE_EQ(summarize({}, library).precision.value, 1.0);
    EXPECT_DOUBLE_EQ(summarize({}, library).recall.value, 0.0);
}

std::vector<std::size_t> objects_of(const std::vector<RecallBin>& bins) {
    std::vector<std::size_t> objects;
    for (const RecallBin& bin : bins) objects.push_back(bin.objects);
    return objects;
}

TEST(RecallBins, AddUpToAllObjectsThatCount) {
    const ModelLibrary library = two_models();
    const std::vector<SceneRecord> records = two_scenes(library);
    // Hidden: 0.05, 0.45, 0.15 (hits) and 0.65 (missed); the object that is 0.05 visible is
    // ignored.
    const auto occlusion = recall_by_occlusion(records, library, kFromHalf, 10);
    EXPECT_EQ(objects_of(occlusion), (std::vector<std::size_t>{1, 1, 0, 0, 1, 0, 1, 0, 0, 0}));
    EXPECT_DOUBLE_EQ(occlusion[4].recall.value, 1.0);
    EXPECT_DOUBLE_EQ(occlusion[6].recall.value, 0.0);
    EXPECT_DOUBLE_EQ(occlusion[6].low, 0.6);
    EXPECT_DOUBLE_EQ(occlusion[6].high, 0.7);
    // Clutter: 0.05, 0.45, 0.5 (on a border: it belongs to the upper bin) and 1 (to the last one).
    const auto clutter = recall_by_clutter(records, library, kFromHalf, 10);
    EXPECT_EQ(objects_of(clutter), (std::vector<std::size_t>{1, 0, 0, 0, 1, 1, 0, 0, 0, 1}));
    EXPECT_EQ(objects_of(recall_by_clutter(records, library, kFromHalf, 2)),
              (std::vector<std::size_t>{2, 2}));
    EXPECT_DOUBLE_EQ(recall_by_clutter(records, library, kFromHalf, 2)[1].recall.value, 0.5);
}

TEST(Reliability, SaysHowManyOfTheReportsOfAConfidenceAreRight) {
    const ModelLibrary library = two_models();
    const std::vector<SceneRecord> records = two_scenes(library);
    // Ten bins: 0.05 wrong, 0.55 right, 0.65 wrong, 0.85 and 0.95 right.
    const auto fine = reliability(records, library, kFromHalf, 10);
    ASSERT_EQ(fine.size(), 5U);
    std::vector<double> right;
    for (const ReliabilityBin& bin : fine) {
        EXPECT_EQ(bin.reports, 1U);
        right.push_back(bin.right.value);
    }
    EXPECT_EQ(right, (std::vector<double>{0.0, 1.0, 0.0, 1.0, 1.0}));
    // Two bins: reports below MatchSettings::min_confidence are looked at, too.
    const auto coarse = reliability(records, library, kFromHalf, 2);
    ASSERT_EQ(coarse.size(), 2U);
    EXPECT_EQ(coarse[0].reports, 1U);
    EXPECT_EQ(coarse[1].reports, 4U);
    EXPECT_DOUBLE_EQ(coarse[1].confidence, (0.55 + 0.65 + 0.85 + 0.95) / 4.0);
    EXPECT_DOUBLE_EQ(coarse[1].right.value, 0.75);
}

TEST(Confusion, RowsAddUpToTheTrueObjects) {
    const ModelLibrary library = two_models();
    std::vector<SceneRecord> records = two_scenes(library);
    // A right model in a wrong pose was not recognized.
    records.push_back(record_for(library, {truth_at(1, 0.0, 0.9)}, {report_at(1, 4.5)}));
    // Row a: two hits. Row b: taken for a once, right once, once in a wrong pose.
    EXPECT_EQ(confusion_matrix(records, library, kFromHalf),
              (std::vector<double>{2.0, 0.0, 0.0, 1.0, 1.0, 1.0}));
}

PosePair errors(std::uint32_t report, std::uint32_t truth, double mssd, double mspd) {
    PosePair pair;
    pair.report = report;
    pair.truth = truth;
    pair.adi = 0.0;
    pair.mssd = mssd;
    pair.mspd = mspd;
    return pair;
}

TEST(AverageRecalls, AgreeWithValuesWorkedOutByHand) {
    SceneRecord record;
    record.image_width = 320;  // pixel thresholds are 2.5, 5, ..., 25
    record.truth = {truth_at(0, 0.0, 0.9), truth_at(0, 40.0, 0.05), truth_at(1, 80.0, 0.5)};
    record.clutter.assign(3, 0.5);
    record.reports = {report_at(0, 0.0, 0.9), report_at(0, 0.0, 0.8), report_at(1, 80.0, 0.7)};
    record.pairs = {errors(0, 0, 0.12, 6.0), errors(1, 0, 0.01, 0.1), errors(2, 2, 0.31, 30.0)};
    record.pairs[0].vsd.assign(10, 0.0);
    record.pairs[1].vsd.assign(10, 0.0);
    record.pairs[2].vsd = {1.0, 1.0, 1.0, 1.0, 1.0, 0.22, 0.22, 0.22, 0.22, 0.22};
    // One target of each model, as one "a" is hardly visible; so the second report of "a" isn't
    // judged, though it is the better one.
    const AverageRecalls recalls = average_recalls(std::vector<SceneRecord>{record});
    EXPECT_TRUE(recalls.has_images);
    EXPECT_TRUE(recalls.has_vsd);
    // 0.12 is below 0.15 to 0.5: 8 of 10. 0.31 is below 0.35 to 0.5: 4 of 10.
    EXPECT_NEAR(recalls.mssd, (0.8 + 0.4) / 2.0, 1e-12);
    // 6 pixels are below 7.5 to 25: 8 of 10. 30 are below none.
    EXPECT_NEAR(recalls.mspd, (0.8 + 0.0) / 2.0, 1e-12);
    // Half of the tolerances give 0.22, which is below 0.25 to 0.5: 6 of 10.
    EXPECT_NEAR(recalls.vsd, (1.0 + 0.5 * 0.6) / 2.0, 1e-12);
    EXPECT_NEAR(recalls.all(), (0.6 + 0.4 + 0.65) / 3.0, 1e-12);
}

TEST(AverageRecalls, ATrueObjectIsFoundOnceAndAllTargetsCount) {
    SceneRecord record;
    record.truth = {truth_at(0, 0.0, 0.9), truth_at(0, 40.0, 0.9)};
    record.clutter.assign(2, 0.5);
    record.reports = {report_at(0, 0.0, 0.9), report_at(0, 0.0, 0.8)};
    record.pairs = {errors(0, 0, 0.0, -1.0), errors(1, 0, 0.0, -1.0)};
    SceneRecord unseen = record;
    unseen.reports.clear();
    unseen.pairs.clear();
    const AverageRecalls recalls = average_recalls(std::vector<SceneRecord>{record, unseen});
    EXPECT_FALSE(recalls.has_images);
    EXPECT_FALSE(recalls.has_vsd);
    EXPECT_NEAR(recalls.mssd, 0.25, 1e-12);
    EXPECT_EQ(average_recalls({}).mssd, 0.0);
    // Three targets found at all thresholds: 1, not a rounded sum of thirtieths.
    record.truth.push_back(truth_at(0, 80.0, 0.9));
    record.reports.push_back(report_at(0, 80.0, 0.7));
    record.pairs = {errors(0, 0, 0.0, -1.0), errors(1, 1, 0.0, -1.0), errors(2, 2, 0.0, -1.0)};
    EXPECT_EQ(average_recalls(std::vector<SceneRecord>{record}).mssd, 1.0);
}

}  // namespace
}  // namespace ostraka
