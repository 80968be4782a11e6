// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/segments.hpp"

#include <algorithm>

#include "ostraka/base/error.hpp"
#include "ostraka/library/bags.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kMinPoints = 10;  // a segment with fewer counts as not recognized

// Sums by scene of the trials' values: the units that the bootstrap draws.
struct ByScene {
    std::vector<double> parts;
    std::vector<double> wholes;
};

template <class Value>
ByScene sum_by_scene(std::span<const SegmentTrial> trials, const Value& value) {
    std::map<std::size_t, std::pair<double, double>> sums;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        auto& [part, whole] = sums[trials[i].scene];
        part += value(i);
        whole += 1.0;
    }
    ByScene result;
    for (const auto& [scene, sum] : sums) {
        result.parts.push_back(sum.first);
        result.wholes.push_back(sum.second);
    }
    return result;
}

}  // namespace

std::vector<LabeledSegment> segments_of(const TestScene& scene, std::size_t number,
                                        const SegmentSettings& settings) {
    std::vector<LabeledSegment> segments;
    for (std::uint32_t object = 0; object < scene.objects.size(); ++object) {
        const TrueObject& truth = scene.objects[object];
        if (truth.visible_fraction < settings.min_visible) continue;
        if (truth.visible_fraction > settings.max_visible) continue;
        std::vector<std::uint32_t> points;
        for (std::uint32_t i = 0; i < scene.labels.size(); ++i) {
            if (scene.labels[i] == object) points.push_back(i);
        }
        segments.push_back(
            {truth.model, truth.visible_fraction, select(scene.cloud, points), number});
    }
    return segments;
}

std::vector<std::string> methods_of(const ModelLibrary& library) {
    std::vector<std::string> methods;
    for (const DescriptorTable& table : library.tables) {
        methods.emplace_back(descriptor_name(table.descriptor));
    }
    if (library.codebook.size() > 0) methods.emplace_back(kBagOfWords);
    methods.insert(methods.end(), {"keypoints", "fused"});
    return methods;
}

SegmentTrial try_segment(const EntryIndex& index, const LabeledSegment& segment,
                         std::span<const std::size_t> ks) {
    SegmentTrial trial{segment.scene, segment.model, segment.visible_fraction, {}};
    const std::vector<std::string> methods = methods_of(index.library());
    for (const std::string& method : methods) trial.answers[method].assign(ks.size(), kNoIndex);
    const PreparedSegment prepared = prepare_segment(segment.cloud, index.library().settings);
    if (prepared.piece.size() < kMinPoints) return trial;
    const SegmentEvidence evidence = gather_evidence(index, prepared);
    for (const std::string& method : methods) {
        for (std::size_t i = 0; i < ks.size(); ++i) {
            const auto ranking = method == kBagOfWords
                                     ? classify(index, prepared, method, ks[i])
                                     : rank_models(index, evidence, method, ks[i]);
            if (!ranking.empty()) trial.answers[method][i] = ranking.front().model;
        }
    }
    return trial;
}

Interval recognition_rate(std::span<const SegmentTrial> trials, const std::string& method,
                          std::size_t k_index) {
    const ByScene sums = sum_by_scene(
        trials, [&](std::size_t i) { return trials[i].right(method, k_index) ? 1.0 : 0.0; });
    return bootstrap_ratio(sums.parts, sums.wholes);
}

Interval recognition_gain(std::span<const SegmentTrial> trials,
                          std::span<const SegmentTrial> baseline, const std::string& method,
                          std::size_t k_index) {
    const bool same = std::equal(trials.begin(), trials.end(), baseline.begin(), baseline.end(),
                                 [](const SegmentTrial& a, const SegmentTrial& b) {
                                     return a.scene == b.scene && a.model == b.model &&
                                            a.visible_fraction == b.visible_fraction;
                                 });
    if (!same) throw InvalidInput("a gain needs two libraries tried on the same segments");
    const ByScene sums = sum_by_scene(trials, [&](std::size_t i) {
        return (trials[i].right(method, k_index) ? 1.0 : 0.0) -
               (baseline[i].right(method, k_index) ? 1.0 : 0.0);
    });
    return bootstrap_ratio(sums.parts, sums.wholes);
}

std::vector<double> confusion_matrix(std::span<const SegmentTrial> trials,
                                     const std::string& method, std::size_t k_index,
                                     std::size_t models) {
    std::vector<double> counts(models * (models + 1), 0.0);
    for (const SegmentTrial& trial : trials) {
        const std::uint32_t answer = trial.answers.at(method)[k_index];
        counts[trial.model * (models + 1) + std::min<std::size_t>(answer, models)] += 1.0;
    }
    return counts;
}

}  // namespace ostraka
