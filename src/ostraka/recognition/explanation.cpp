// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/explanation.hpp"

#include <algorithm>
#include <optional>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/recognition/confidence.hpp"
#include "ostraka/recognition/explanation_words.hpp"
#include "ostraka/recognition/refinement.hpp"

namespace ostraka {
namespace {

constexpr double kSamePose = 0.05;   // diameters that equal poses may differ by
constexpr double kSamePlace = 0.25;  // diameters between centers of one place

const Model& model_of(const ModelLibrary& library, const RecognizedObject& object) {
    if (object.model_index >= library.models.size()) {
        throw InvalidInput("\"" + object.model + "\" is not in the library");
    }
    return library.models[object.model_index];
}

bool same_pose(const RecognizedObject& a, const RecognizedObject& b, const MeshShape& shape) {
    return a.model_index == b.model_index &&
           nearly_equal(a.T_scene_model, b.T_scene_model, shape, kSamePose * shape.diameter);
}

bool same_place(const RecognizedObject& a, const RecognizedObject& b, const MeshShape& shape) {
    const Vec3d apart = a.T_scene_model * shape.center - b.T_scene_model * shape.center;
    return a.model_index == b.model_index && apart.norm() < kSamePlace * shape.diameter;
}

// Candidates that weren't reported, the most confident of each (model, place); indices.
std::vector<std::size_t> near_misses(const ModelLibrary& library, const Recognition& recognition,
                                     std::size_t most) {
    const std::vector<RecognizedObject>& all = recognition.candidates;
    std::vector<std::size_t> order(all.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return all[a].confidence > all[b].confidence;
    });
    std::vector<std::size_t> chosen;
    for (const std::size_t i : order) {
        if (chosen.size() >= most) break;
        const MeshShape& shape = model_of(library, all[i]).shape;
        const bool reported = std::any_of(
            recognition.objects.begin(), recognition.objects.end(),
            [&](const RecognizedObject& object) { return same_pose(all[i], object, shape); });
        const bool known = std::any_of(chosen.begin(), chosen.end(), [&](std::size_t other) {
            return same_place(all[i], all[other], shape);
        });
        if (!reported && !known) chosen.push_back(i);
    }
    return chosen;
}

Outcome outcome_of(const Explanation& one, double min_confidence) {
    if (one.number != kNoIndex) return Outcome::reported;
    if (one.object.confidence >= min_confidence) return Outcome::lost;
    return too_small(one.verified) ? Outcome::too_small : Outcome::doubtful;
}

// The probes of the models that are needed; making them all takes as long as a scan.
std::vector<std::optional<ModelProbe>> probes_for(const ModelLibrary& library,
                                                  const std::vector<Explanation>& explanations) {
    std::vector<char> needed(library.models.size(), 0);
    for (const Explanation& one : explanations) needed[one.object.model_index] = 1;
    std::vector<std::optional<ModelProbe>> probes(library.models.size());
    parallel_for(probes.size(), [&](std::size_t m) {
        if (needed[m] != 0) probes[m].emplace(library.models[m], library.settings.sampling);
    });
    return probes;
}

}  // namespace

std::vector<Explanation> explain(const ModelLibrary& library, const Recognition& recognition,
                                 const Scan& scan, const RecognitionSettings& settings,
                                 const ExplanationSettings& wish) {
    std::vector<Explanation> all;
    for (std::uint32_t k = 0; k < recognition.objects.size(); ++k) {
        model_of(library, recognition.objects[k]);
        all.push_back({.object = recognition.objects[k], .number = k});
    }
    for (const std::size_t i : near_misses(library, recognition, wish.near_misses)) {
        const std::uint32_t rival =
            i < recognition.lost_to.size() ? recognition.lost_to[i] : kNoIndex;
        all.push_back({.object = recognition.candidates[i], .rival = rival});
    }
    if (scan.cloud.empty()) return all;
    const auto probes = probes_for(library, all);
    const double tolerance = settings.tolerance * scan.sampling;
    parallel_for(all.size(), [&](std::size_t i) {
        Explanation& one = all[i];
        const Hypothesis hypothesis{.model = one.object.model_index,
                                    .T_scene_model = one.object.T_scene_model};
        one.verified = verify(scan, *probes[hypothesis.model], hypothesis, tolerance, &one.cells);
        one.outcome = outcome_of(one, settings.min_confidence);
        one.reasons = reasons_of(one, recognition.judge, wish.unit);
        one.verdict = verdict_of(one, recognition.objects, settings.min_confidence);
    });
    return all;
}

}  // namespace ostraka
