// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/calibration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/base/random.hpp"
#include "ostraka/evaluation/scenes.hpp"

namespace ostraka {
namespace {

using Vector = Eigen::Matrix<double, static_cast<int>(kFeatures), 1>;
using Matrix = Eigen::Matrix<double, static_cast<int>(kFeatures), static_cast<int>(kFeatures)>;

constexpr int kKinds = 3;                                    // of scenes, in turns
constexpr std::array<double, 3> kNoises = {0.15, 0.3, 0.6};  // sampling distances, in turns
constexpr int kObjects = 8;                                  // dropped in each heap
constexpr double kLeastConfidence = 0.02;  // of examples: what is below never matters
constexpr int kSteps = 100;                // of Newton's method, at most
constexpr double kFarOff = 30.0;           // a logit that is as good as infinite

double mean_diameter_of(const ModelLibrary& library) {
    double sum = 0.0;
    for (const Model& model : library.models) sum += model.shape.diameter;
    return sum / static_cast<double>(library.models.size());
}

SceneRecipe recipe_of(const ModelLibrary& library, int kind, double noise, std::uint64_t seed) {
    SensorModel sensor;
    sensor.ranging.noise = noise * library.settings.sampling;
    sensor.ranging.seed = seed;
    if (kind == 0) return RandomViewSettings{.sensor = sensor, .seed = seed};
    DropScenes drop{.objects = kObjects, .sensor = sensor, .seed = seed};
    if (kind == 1) {
        drop.drop.area = 0.8 * std::sqrt(static_cast<double>(kObjects));
        drop.choice = ModelChoice::random;
    } else {
        const double d = mean_diameter_of(library);
        drop.drop.bin = BinSettings{2.6 * d, 1.8 * d, 0.9 * d, 0.05 * d};
        drop.min_elevation = 1.1;
        drop.max_elevation = 1.5;
    }
    return drop;
}

// Half of the models, drawn anew for each scene; all in every other scene.
std::vector<std::uint32_t> known_models(const ModelLibrary& library, int scene,
                                        std::uint64_t seed) {
    if (scene % 2 == 0 || library.models.size() < 2) return {};
    std::vector<std::uint32_t> known(library.models.size());
    for (std::uint32_t m = 0; m < known.size(); ++m) known[m] = m;
    Random random(seed, static_cast<std::uint64_t>(scene));
    for (std::uint32_t i = static_cast<std::uint32_t>(known.size()) - 1; i > 0; --i) {
        std::swap(known[i], known[random.below(i + 1)]);
    }
    known.resize((known.size() + 1) / 2);
    std::sort(known.begin(), known.end());
    return known;
}

std::vector<Example> examples_of(const TestScene& scene, const Recognizer& recognizer,
                                 const PoseJudge& judge, const SceneSettings& settings,
                                 double max_adi) {
    const Recognition answer = recognizer.recognize(scene.cloud, settings.recognition);
    std::vector<Example> examples;
    for (const RecognizedObject& object : answer.objects) {
        examples.push_back({.features = object.features});
    }
    for (const PosePair& pair : judge.judge(scene, answer.objects, settings)) {
        if (pair.adi < max_adi) examples[pair.report].right = true;
    }
    return examples;
}

}  // namespace

std::vector<Example> calibration_examples(const ModelLibrary& library,
                                          const CalibrationSettings& settings,
                                          const Progress& progress) {
    if (settings.scenes < 1) throw InvalidInput("at least one scene is needed");
    const Recognizer recognizer(library);
    const PoseJudge judge(library, false);
    std::vector<Example> examples;
    for (int scene = 0; scene < settings.scenes; ++scene) {
        report(progress, "calibrate", static_cast<std::size_t>(scene),
               static_cast<std::size_t>(settings.scenes));
        const std::uint64_t seed = settings.seed * 1000003 + static_cast<std::uint64_t>(scene);
        // Kinds, noises and what is known go in turns of different lengths.
        const double noise = kNoises[static_cast<std::size_t>(scene / kKinds) % kNoises.size()];
        const TestSet set =
            simulated_set(library, recipe_of(library, scene % kKinds, noise, seed), 1);
        SceneSettings scene_settings;
        scene_settings.recognition.min_confidence = kLeastConfidence;
        scene_settings.recognition.only = known_models(library, scene, seed);
        const auto some =
            examples_of(set.load(0), recognizer, judge, scene_settings, settings.max_adi);
        examples.insert(examples.end(), some.begin(), some.end());
    }
    report(progress, "calibrate", static_cast<std::size_t>(settings.scenes),
           static_cast<std::size_t>(settings.scenes));
    return examples;
}

ConfidenceModel fit_confidence(std::span<const Example> examples, const ConfidenceModel& from,
                               double prior) {
    const Vector mean = Eigen::Map<const Vector>(from.weights.data());
    Vector weights = mean;
    for (int step = 0; step < kSteps; ++step) {
        Vector slope = -prior * (weights - mean);
        Matrix curvature = prior * Matrix::Identity();
        for (const Example& example : examples) {
            const Vector x = Eigen::Map<const Vector>(example.features.data());
            const double logit = std::clamp(weights.dot(x), -kFarOff, kFarOff);
            const double p = 1.0 / (1.0 + std::exp(-logit));
            slope += ((example.right ? 1.0 : 0.0) - p) * x;
            curvature += p * (1.0 - p) * x * x.transpose();
        }
        const Vector move = curvature.ldlt().solve(slope);
        weights += move;
        if (move.cwiseAbs().maxCoeff() < 1e-10) break;
    }
    ConfidenceModel model;
    Eigen::Map<Vector>(model.weights.data()) = weights;
    return model;
}

}  // namespace ostraka
