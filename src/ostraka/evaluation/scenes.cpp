// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/scenes.hpp"

#include <algorithm>

#include "ostraka/evaluation/metrics.hpp"

namespace ostraka {
namespace {

struct Pair {
    double adi = 0.0;
    std::size_t report = 0;
    std::size_t truth = 0;
};

// All pairs of the same model within the limit, best first.
std::vector<Pair> possible_pairs(const Recognition& recognition, std::span<const TrueObject> truth,
                                 const ModelLibrary& library, double max_adi) {
    std::vector<Pair> pairs;
    for (std::size_t r = 0; r < recognition.objects.size(); ++r) {
        const RecognizedObject& report = recognition.objects[r];
        const Model& model = library.models[report.model_index];
        for (std::size_t t = 0; t < truth.size(); ++t) {
            if (truth[t].model != report.model_index) continue;
            const double adi =
                adi_error(model.surface.points, truth[t].T_scene_model, report.T_scene_model) /
                model.shape.diameter;
            if (adi < max_adi) pairs.push_back({adi, r, t});
        }
    }
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& a, const Pair& b) { return a.adi < b.adi; });
    return pairs;
}

}  // namespace

SceneOutcome match_outcome(const Recognition& recognition, std::span<const TrueObject> truth,
                           const ModelLibrary& library, const MatchSettings& settings) {
    std::vector<bool> report_used(recognition.objects.size(), false);
    std::vector<bool> truth_used(truth.size(), false);
    SceneOutcome outcome;
    for (const Pair& pair : possible_pairs(recognition, truth, library, settings.max_adi)) {
        if (report_used[pair.report] || truth_used[pair.truth]) continue;
        report_used[pair.report] = truth_used[pair.truth] = true;
        const TrueObject& object = truth[pair.truth];
        if (object.visible_fraction < settings.min_visible) continue;
        outcome.hits.push_back({object.model, object.visible_fraction,
                                recognition.objects[pair.report].confidence, pair.adi});
    }
    for (std::size_t t = 0; t < truth.size(); ++t) {
        if (truth_used[t] || truth[t].visible_fraction < settings.min_visible) continue;
        outcome.misses.push_back({truth[t].model, truth[t].visible_fraction, 0.0, -1.0});
    }
    for (std::size_t r = 0; r < report_used.size(); ++r) {
        if (report_used[r]) continue;
        outcome.wrong.push_back(
            {recognition.objects[r].model_index, 0.0, recognition.objects[r].confidence, -1.0});
    }
    return outcome;
}

SceneSummary summarize(std::span<const SceneOutcome> outcomes) {
    SceneSummary summary;
    std::vector<double> errors;
    for (const SceneOutcome& outcome : outcomes) {
        summary.objects += outcome.hits.size() + outcome.misses.size();
        summary.hits += outcome.hits.size();
        summary.wrong += outcome.wrong.size();
        for (const Outcome& hit : outcome.hits) errors.push_back(hit.adi);
    }
    if (summary.objects > 0) summary.recall = double(summary.hits) / double(summary.objects);
    const std::size_t reports = summary.hits + summary.wrong;
    if (reports > 0) summary.precision = double(summary.hits) / double(reports);
    std::sort(errors.begin(), errors.end());
    if (!errors.empty()) summary.median_adi = errors[errors.size() / 2];
    return summary;
}

}  // namespace ostraka
