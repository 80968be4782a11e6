// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/base/random.hpp"
#include "ostraka/evaluation/test_scenes.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

const ModelLibrary& library() {
    static const ModelLibrary built =
        build_library(testing::simple_models(), testing::quick_settings());
    return built;
}

// Examples whose chance of being right is that of a known logistic function.
std::vector<Example> drawn(const ConfidenceModel& truth, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Example> examples(count);
    for (Example& example : examples) {
        for (double& feature : example.features) feature = random.uniform(0.0, 1.0);
        example.features[0] = 1.0;
        example.right = random.uniform(0.0, 1.0) < truth.confidence(example.features);
    }
    return examples;
}

ConfidenceModel some_model() {
    ConfidenceModel model;
    Random random(6);
    double sum = 0.0;
    for (double& weight : model.weights) sum += weight = random.uniform(-3.0, 3.0);
    model.weights[0] -= 0.5 * (sum + model.weights[0]);  // as many right as wrong, about
    return model;
}

TEST(FitConfidence, FindsTheFunctionThatMadeTheExamples) {
    const ConfidenceModel truth = some_model();
    const ConfidenceModel fit = fit_confidence(drawn(truth, 100'000, 1), {}, 1e-6);
    for (std::size_t i = 0; i < kFeatures; ++i) {
        EXPECT_NEAR(fit.weights[i], truth.weights[i], 0.25);
    }
}

TEST(FitConfidence, IsCalibrated) {
    const ConfidenceModel truth = some_model();
    const ConfidenceModel fit = fit_confidence(drawn(truth, 4000, 2), {}, 0.1);
    double sum = 0.0;
    double right = 0.0;
    for (const Example& example : drawn(truth, 20'000, 3)) {
        const double p = fit.confidence(example.features);
        if (p < 0.8) continue;
        sum += p;
        right += example.right ? 1.0 : 0.0;
    }
    EXPECT_NEAR(right / sum, 1.0, 0.04);
}

TEST(FitConfidence, WithoutExamplesOrWithAStrongPriorItIsThePrior) {
    const ConfidenceModel prior = some_model();
    EXPECT_EQ(fit_confidence({}, prior, 1.0).weights, prior.weights);
    const ConfidenceModel held = fit_confidence(drawn({}, 500, 4), prior, 1e9);
    for (std::size_t i = 0; i < kFeatures; ++i) {
        EXPECT_NEAR(held.weights[i], prior.weights[i], 1e-4);
    }
}

TEST(FitConfidence, ExamplesThatCanBeToldApartStayFinite) {
    std::vector<Example> examples = drawn({}, 100, 5);
    for (Example& example : examples) example.right = example.features[1] > 0.5;
    const ConfidenceModel fit = fit_confidence(examples, {}, 0.5);
    for (const double weight : fit.weights) EXPECT_TRUE(std::isfinite(weight));
    EXPECT_GT(fit.weights[1], 1.0);
}

TEST(CalibrationExamples, AreTheSameAgainAndMostlyRight) {
    const auto once = calibration_examples(library(), {.scenes = 3});
    const auto again = calibration_examples(library(), {.scenes = 3});
    ASSERT_EQ(once.size(), again.size());
    ASSERT_GT(once.size(), 4U);
    std::size_t right = 0;
    for (std::size_t i = 0; i < once.size(); ++i) {
        EXPECT_EQ(once[i].features, again[i].features);
        EXPECT_EQ(once[i].right, again[i].right);
        right += once[i].right ? 1U : 0U;
    }
    EXPECT_GT(right, 2U);
    EXPECT_THROW(calibration_examples(library(), {.scenes = 0}), InvalidInput);
}

TEST(ForLibrary, UnknownObjectsStayInTheScanButNotInTheTruth) {
    ModelLibrary fewer = library();
    fewer.models.erase(fewer.models.begin());  // the other one is number 0 now
    const TabletopScenes recipe{{.objects = 4, .seed = 2}, ModelChoice::in_turns};
    const TestSet all = simulated_set(library(), recipe, 3);
    const TestSet some = for_library(simulated_set(library(), recipe, 3), library(), fewer);
    for (std::size_t i = 0; i < 3; ++i) {
        const TestScene full = all.load(i);
        const TestScene part = some.load(i);
        EXPECT_EQ(part.cloud.size(), full.cloud.size());
        std::size_t known = 0;
        for (const TrueObject& object : full.objects) known += object.model == 1 ? 1U : 0U;
        EXPECT_EQ(part.objects.size(), known);
        for (const TrueObject& object : part.objects) EXPECT_EQ(object.model, 0U);
        for (std::size_t k = 0; k < full.labels.size(); ++k) {
            const bool of_known =
                full.labels[k] != kNoIndex && full.objects[full.labels[k]].model == 1;
            ASSERT_EQ(part.labels[k] != kNoIndex, of_known);
        }
    }
    fewer.models[0].name = "nobody";
    EXPECT_THROW(for_library(simulated_set(library(), recipe, 3), library(), fewer), InvalidInput);
}

// All features alike and all right: the prior on the average logit is all that holds, as if the
// constant were the only feature.
TEST(FitConfidence, FeaturesThatDoNotVaryDoNotMoveTheAverageTogether) {
    constexpr double kPrior = 8.0;
    constexpr int kCount = 100;
    Example example{.right = true};
    example.features.fill(1.0);
    const std::vector<Example> examples(kCount, example);
    double logit = 0.0;  // kCount (1 - p) = kPrior logit, by bisection
    for (double step = 10.0; step > 1e-12; step /= 2.0) {
        const double p = 1.0 / (1.0 + std::exp(-(logit + step)));
        if (kCount * (1.0 - p) > kPrior * (logit + step)) logit += step;
    }
    const double p = fit_confidence(examples, {}, kPrior).confidence(example.features);
    EXPECT_NEAR(std::log(p / (1.0 - p)), logit, 1e-6);
}

}  // namespace
}  // namespace ostraka
