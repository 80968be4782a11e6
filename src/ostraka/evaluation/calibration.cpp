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

constexpr std::size_t kKinds = 3;  // of scenes
struct Quality {
    double noise;  // sampling distances
    int width;     // pixels of the sensor; 0: its own
    bool faults;   // holes, shadows, lost edges and grazing rays (docs/sensors.md)
};
constexpr std::array<Quality, 4> kQualities = {
    {{0.15, 0, false}, {0.3, 400, true}, {0.6, 0, true}, {2.0, 0, false}}};
constexpr std::size_t kConditions = kKinds * kQualities.size();
constexpr std::size_t kFewKnown = 6;       // one in six: then hardly any model has a rival
constexpr int kObjects = 8;                // dropped in each heap
constexpr double kLeastConfidence = 0.02;  // of examples: what is below never matters
constexpr double kTurned = 2.0;            // of max_adi: MSSD from which a pose is turned wrongly
constexpr int kSteps = 100;                // of Newton's method, at most
constexpr double kFarOff = 30.0;           // a logit that is as good as infinite

SensorModel sensor_of(const ModelLibrary& library, const Quality& quality, std::uint64_t seed) {
    const double sampling = library.settings.sampling;
    SensorModel sensor;
    sensor.ranging.noise = quality.noise * sampling;
    sensor.ranging.seed = seed;
    if (!quality.faults) return sensor;
    sensor.ranging.max_grazing_angle = 1.4;
    sensor.free_grazing_angle = 1.1;
    sensor.projector.x() = 0.5 * mean_diameter(library);
    sensor.edge_step = 3.0 * sampling;
    sensor.edge_dropout = 0.3;
    sensor.holes = 0.01;
    return sensor;
}

SceneRecipe recipe_of(const ModelLibrary& library, std::size_t condition, std::uint64_t seed) {
    const std::size_t kind = condition % kKinds;
    const Quality& quality = kQualities[condition / kKinds];
    const SensorModel sensor = sensor_of(library, quality, seed);
    if (kind == 0) {
        RandomViewSettings views{.sensor = sensor, .seed = seed};
        views.camera = resized(views.camera, 2 * quality.width);
        return views;
    }
    DropScenes drop{.objects = kObjects, .sensor = sensor, .seed = seed};
    drop.camera = resized(drop.camera, quality.width);
    if (kind == 1) {
        drop.drop.area = 0.8 * std::sqrt(static_cast<double>(kObjects));
        drop.choice = ModelChoice::random;
    } else {
        drop.drop.bin = usual_bin(mean_diameter(library));
        drop.min_elevation = 1.1;
        drop.max_elevation = 1.5;
    }
    return drop;
}

// All models in every other scene; else half of them or a few, drawn anew for each scene.
std::vector<std::uint32_t> known_models(const ModelLibrary& library, std::size_t scene,
                                        std::uint64_t seed) {
    if (scene % 2 == 0 || library.models.size() < 2) return {};
    std::vector<std::uint32_t> known(library.models.size());
    for (std::uint32_t m = 0; m < known.size(); ++m) known[m] = m;
    Random random(seed, scene);
    for (std::uint32_t i = static_cast<std::uint32_t>(known.size()) - 1; i > 0; --i) {
        std::swap(known[i], known[random.below(i + 1)]);
    }
    const std::size_t share = scene % 4 == 1 ? 2 : kFewKnown;
    known.resize((known.size() + share - 1) / share);
    std::sort(known.begin(), known.end());
    return known;
}

// What is in the right place but turned wrongly, as near-symmetric parts are, is an example of
// neither: as right ones they taught that contradictions don't matter.
std::vector<Example> examples_of(const TestScene& scene, const Recognizer& recognizer,
                                 const PoseJudge& judge, const SceneSettings& settings,
                                 double max_adi) {
    const Recognition answer = recognizer.recognize(scene.cloud, settings.recognition);
    enum class Report : std::uint8_t { wrong, right, turned };
    std::vector<Report> reports(answer.objects.size(), Report::wrong);
    for (const PosePair& pair : judge.judge(scene, answer.objects, settings)) {
        if (pair.adi >= max_adi) continue;
        reports[pair.report] = pair.mssd < kTurned * max_adi ? Report::right : Report::turned;
    }
    std::vector<Example> examples;
    for (std::size_t i = 0; i < reports.size(); ++i) {
        if (reports[i] == Report::turned) continue;
        examples.push_back({answer.objects[i].features, reports[i] == Report::right});
    }
    return examples;
}

// 0 of the constant.
Vector mean_features(std::span<const Example> examples) {
    Vector sum = Vector::Zero();
    for (const Example& example : examples) {
        sum += Eigen::Map<const Vector>(example.features.data());
    }
    if (!examples.empty()) sum /= static_cast<double>(examples.size());
    sum(0) = 0.0;
    return sum;
}

}  // namespace

std::vector<Example> calibration_examples(const ModelLibrary& library,
                                          const CalibrationSettings& settings,
                                          const Progress& progress) {
    if (settings.scenes < 1) throw InvalidInput("at least one scene is needed");
    const Recognizer recognizer(library);
    const PoseJudge judge(library, false);
    const auto scenes = static_cast<std::size_t>(settings.scenes);
    std::vector<Example> examples;
    std::size_t done = 0;
    for (std::size_t condition = 0; condition < std::min(scenes, kConditions); ++condition) {
        // As many of each as of the others, or one less. A set prepares its models once.
        const std::size_t count = (scenes - condition - 1) / kConditions + 1;
        const std::uint64_t seed = settings.seed * 1000003 + condition;
        const TestSet set = simulated_set(library, recipe_of(library, condition, seed), count);
        for (std::size_t number = 0; number < count; ++number) {
            report(progress, "calibrate", done++, scenes);
            SceneSettings scene_settings;
            scene_settings.recognition.min_confidence = kLeastConfidence;
            scene_settings.recognition.viewpoint_known = settings.kind == ScanKind::one_viewpoint;
            scene_settings.recognition.only = known_models(library, condition + number, seed);
            const auto some =
                examples_of(set.load(number), recognizer, judge, scene_settings, settings.max_adi);
            examples.insert(examples.end(), some.begin(), some.end());
        }
    }
    report(progress, "calibrate", scenes, scenes);
    return examples;
}

ConfidenceModel fit_confidence(std::span<const Example> examples, const ConfidenceModel& from,
                               double prior) {
    // Most features of reports are far from 0 and nearly the same: without this their weights would
    // move the constant, together much farther than the prior lets it move.
    const Vector middle = mean_features(examples);
    Vector mean = Eigen::Map<const Vector>(from.weights.data());
    mean(0) += mean.dot(middle);
    Vector weights = mean;
    for (int step = 0; step < kSteps; ++step) {
        Vector slope = -prior * (weights - mean);
        Matrix curvature = prior * Matrix::Identity();
        for (const Example& example : examples) {
            const Vector x = Eigen::Map<const Vector>(example.features.data()) - middle;
            const double logit = std::clamp(weights.dot(x), -kFarOff, kFarOff);
            const double p = 1.0 / (1.0 + std::exp(-logit));
            slope += ((example.right ? 1.0 : 0.0) - p) * x;
            curvature += p * (1.0 - p) * x * x.transpose();
        }
        const Vector move = curvature.ldlt().solve(slope);
        weights += move;
        if (move.cwiseAbs().maxCoeff() < 1e-10) break;
    }
    weights(0) -= weights.dot(middle);
    ConfidenceModel model;
    Eigen::Map<Vector>(model.weights.data()) = weights;
    return model;
}

}  // namespace ostraka
