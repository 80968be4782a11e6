// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/recognize.hpp"

#include <algorithm>
#include <optional>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/recognition/choice.hpp"
#include "ostraka/recognition/scene_search.hpp"

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

RecognizedObject report_object(const Judged& judged, const Standing& standing,
                               const ModelLibrary& library) {
    const Verified& verified = judged.verified;
    const Hypothesis& hypothesis = verified.hypothesis;
    return {.model = library.models[hypothesis.model].name,
            .model_index = hypothesis.model,
            .T_scene_model = hypothesis.T_scene_model,
            .confidence = standing.confidence,
            .visible_fraction = verified.visible_fraction,
            .inlier_rms = verified.inlier_rms,
            .source = std::string(source_name(hypothesis.source)),
            .round = judged.round,
            .features = standing.features,
            .rival = standing.rival_model == kNoIndex ? std::string()
                                                      : library.models[standing.rival_model].name};
}

// Of the reported ones that explain too much of the same, the one that explains most of it.
std::uint32_t winner_over(std::size_t candidate, const std::vector<Judged>& judged,
                          const std::vector<std::size_t>& reported) {
    std::uint32_t winner = kNoIndex;
    double most = 0.0;
    for (std::size_t k = 0; k < reported.size(); ++k) {
        const Verified& rival = judged[reported[k]].verified;
        const double shared = shared_support(judged[candidate].verified, rival);
        if (reported[k] == candidate) return static_cast<std::uint32_t>(k);
        if (shared <= most || !in_conflict(judged[candidate].verified, rival)) continue;
        winner = static_cast<std::uint32_t>(k);
        most = shared;
    }
    return winner;
}

void add_candidates(const SceneSearch& search, const std::vector<std::size_t>& reported,
                    const ModelLibrary& library, Recognition& result) {
    const std::vector<Judged>& judged = search.judged();
    result.lost_to.resize(judged.size());
    result.candidates.resize(judged.size());
    parallel_for(judged.size(), [&](std::size_t i) {
        result.lost_to[i] = winner_over(i, judged, reported);
        // Of what lost its own confidence is told: that it has a rival is known.
        const bool lost = result.lost_to[i] != kNoIndex && reported[result.lost_to[i]] != i;
        const Standing standing =
            lost ? Standing{judged[i].features, judged[i].verified.confidence} : search.standing(i);
        result.candidates[i] = report_object(judged[i], standing, library);
    });
}

}  // namespace

struct Recognizer::Implementation {
    explicit Implementation(const ModelLibrary& given)
        : library(given), index(given), probes(make_probes(given)) {
        if (given.models.empty()) throw InvalidInput("the library has no models");
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
    const Stopwatch watch;
    Scan scan = prepare_scan(self.library, scene, settings);
    result.scan_points = scan.cloud.size();
    result.table_found = scan.table.has_value();
    const double prepared = watch.seconds();
    if (scan.cloud.empty()) return result;  // nothing but a table

    SceneSearch search(self.index, self.probes, std::move(scan), settings, watch);
    search.run();
    const std::vector<std::size_t> reported = search.explanation(settings.min_confidence);
    for (const std::size_t i : reported) {
        result.objects.push_back(
            report_object(search.judged()[i], search.standing(i), self.library));
    }
    if (settings.keep_candidates) {
        add_candidates(search, reported, self.library, result);
    }
    result.judge = search.confidence_model();
    result.seconds = search.seconds();
    result.seconds["prepare"] = prepared;
    result.out_of_time = search.out_of_time();
    return result;
}

Scan prepare_scan(const ModelLibrary& library, const PointCloud& scene,
                  const RecognitionSettings& settings) {
    return prepare_scan(scene, library.settings.sampling, largest_diameter(library), settings);
}

Recognition recognize(const ModelLibrary& library, const PointCloud& scene,
                      const RecognitionSettings& settings) {
    return Recognizer(library).recognize(scene, settings);
}

}  // namespace ostraka
