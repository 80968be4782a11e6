// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/recognize.hpp"

#include <algorithm>
#include <optional>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/recognition/keypoint_matching.hpp"
#include "ostraka/recognition/refinement.hpp"
#include "ostraka/recognition/segment_matching.hpp"
#include "ostraka/recognition/verification.hpp"

namespace ostraka {
namespace {

std::vector<ModelProbe> make_probes(const ModelLibrary& library) {
    std::vector<std::optional<ModelProbe>> slots(library.models.size());
    parallel_for(slots.size(), [&](std::size_t m) {
        slots[m].emplace(library.models[m], library.settings.sampling);
    });
    std::vector<ModelProbe> probes;
    for (auto& slot : slots) probes.push_back(std::move(*slot));
    return probes;
}

double largest_diameter(const ModelLibrary& library) {
    double largest = 0.0;
    for (const Model& model : library.models) largest = std::max(largest, model.shape.diameter);
    return largest;
}

RecognizedObject report_object(const Verified& verified, const ModelLibrary& library) {
    const Hypothesis& hypothesis = verified.hypothesis;
    return {.model = library.models[hypothesis.model].name,
            .model_index = hypothesis.model,
            .T_scene_model = hypothesis.T_scene_model,
            .confidence = verified.confidence,
            .visible_fraction = verified.visible_fraction,
            .inlier_rms = verified.inlier_rms,
            .source = std::string(source_name(hypothesis.source))};
}

}  // namespace

struct Recognizer::Implementation {
    explicit Implementation(const ModelLibrary& given)
        : library(given), index(given), probes(make_probes(given)) {
        if (given.models.empty()) throw InvalidInput("the library has no models");
    }

    // Hypotheses of every source, by model.
    std::vector<std::vector<Hypothesis>> propose(const Scan& scan,
                                                 const RecognitionSettings& settings,
                                                 Recognition& result, Stopwatch& watch) const {
        std::vector<std::vector<Hypothesis>> by_model(library.models.size());
        if (settings.use_segments) {
            for (const Hypothesis& h : hypotheses_from_segments(scan, index, settings)) {
                by_model[h.model].push_back(h);
            }
            result.seconds["segments"] = watch.lap();
        }
        if (settings.use_keypoints) {
            const auto matches =
                match_keypoints(scan, library.settings, index.keypoints(), settings);
            for (std::uint32_t m = 0; m < matches.size(); ++m) {
                for (const Pose& pose : poses_from_matches(matches[m], 2.0 * scan.sampling)) {
                    by_model[m].push_back(
                        {.model = m, .T_scene_model = pose, .source = HypothesisSource::keypoints});
                }
            }
            result.seconds["keypoints"] = watch.lap();
        }
        return by_model;
    }

    const ModelLibrary& library;
    EntryIndex index;
    std::vector<ModelProbe> probes;
};

Recognizer::Recognizer(const ModelLibrary& library)
    : implementation_(std::make_unique<Implementation>(library)) {}
Recognizer::~Recognizer() = default;
Recognizer::Recognizer(Recognizer&&) noexcept = default;
Recognizer& Recognizer::operator=(Recognizer&&) noexcept = default;

Recognition Recognizer::recognize(const PointCloud& scene,
                                  const RecognitionSettings& settings) const {
    const Implementation& self = *implementation_;
    Recognition result;
    Stopwatch watch;
    const Scan scan = prepare_scan(scene, self.library.settings.sampling,
                                   largest_diameter(self.library), settings);
    result.scan_points = scan.cloud.size();
    result.table_found = scan.table.has_value();
    result.seconds["prepare"] = watch.lap();

    const auto proposed = self.propose(scan, settings, result, watch);
    std::vector<Hypothesis> finalists;
    for (std::size_t m = 0; m < proposed.size(); ++m) {
        const auto best = refine_hypotheses(scan, self.probes[m], proposed[m], settings);
        finalists.insert(finalists.end(), best.begin(), best.end());
    }
    result.seconds["refine"] = watch.lap();

    std::vector<Verified> verified(finalists.size());
    parallel_for(finalists.size(), [&](std::size_t i) {
        verified[i] = verify(scan, self.probes[finalists[i].model], finalists[i],
                             settings.tolerance * scan.sampling);
    });
    for (const Verified& chosen : choose(std::move(verified), settings.min_confidence)) {
        result.objects.push_back(report_object(chosen, self.library));
    }
    result.seconds["verify"] = watch.lap();
    return result;
}

Recognition recognize(const ModelLibrary& library, const PointCloud& scene,
                      const RecognitionSettings& settings) {
    return Recognizer(library).recognize(scene, settings);
}

}  // namespace ostraka
