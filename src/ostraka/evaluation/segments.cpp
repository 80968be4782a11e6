// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/segments.hpp"

#include <algorithm>
#include <iterator>
#include <mutex>

#include "ostraka/base/parallel.hpp"
#include "ostraka/library/bags.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kMinPoints = 10;  // a segment with fewer counts as not recognized

std::vector<LabeledSegment> segments_of(const SimulatedScene& scene,
                                        const SegmentSettings& settings) {
    std::vector<LabeledSegment> segments;
    for (std::uint32_t object = 0; object < scene.objects.size(); ++object) {
        const TrueObject& truth = scene.objects[object];
        if (truth.visible_fraction < settings.min_visible) continue;
        if (truth.visible_fraction > settings.max_visible) continue;
        std::vector<std::uint32_t> pixels;
        for (std::uint32_t i = 0; i < scene.labels.size(); ++i) {
            if (scene.labels[i] == object) pixels.push_back(i);
        }
        segments.push_back({truth.model, truth.visible_fraction, select(scene.cloud, pixels)});
    }
    return segments;
}

}  // namespace

std::vector<LabeledSegment> simulate_segments(const SceneModels& models,
                                              const SegmentSettings& settings,
                                              const Progress& progress) {
    const auto count = static_cast<std::size_t>(std::max(0, settings.scenes));
    std::vector<std::vector<LabeledSegment>> of_scene(count);
    std::mutex mutex;
    std::size_t done = 0;
    parallel_for(count, [&](std::size_t i) {
        const SimulatedScene scene = simulate_random_view(models, i, settings.views);
        of_scene[i] = segments_of(scene, settings);
        const std::scoped_lock lock(mutex);
        report(progress, "scenes", ++done, count);
    });
    std::vector<LabeledSegment> all;
    for (std::vector<LabeledSegment>& segments : of_scene) {
        std::move(segments.begin(), segments.end(), std::back_inserter(all));
    }
    return all;
}

std::map<std::string, double> recognition_rates(const EntryIndex& index,
                                                std::span<const LabeledSegment> segments,
                                                std::size_t k) {
    std::vector<std::string> names = {"fused", "keypoints"};
    for (const DescriptorTable& table : index.library().tables) {
        names.emplace_back(descriptor_name(table.descriptor));
    }
    if (index.library().codebook.size() > 0) names.emplace_back(kBagOfWords);
    std::vector<std::vector<int>> right(names.size(), std::vector<int>(segments.size(), 0));
    parallel_for(segments.size(), [&](std::size_t s) {
        const PreparedSegment prepared =
            prepare_segment(segments[s].cloud, index.library().settings);
        if (prepared.piece.size() < kMinPoints) return;
        const SegmentEvidence evidence = gather_evidence(index, prepared);
        for (std::size_t n = 0; n < names.size(); ++n) {
            const auto ranking = names[n] == kBagOfWords
                                     ? classify(index, prepared, names[n], k)
                                     : rank_models(index, evidence, names[n], k);
            right[n][s] = !ranking.empty() && ranking.front().model == segments[s].model ? 1 : 0;
        }
    });
    std::map<std::string, double> rates;
    for (std::size_t n = 0; n < names.size(); ++n) {
        double sum = 0.0;
        for (const int value : right[n]) sum += value;
        rates[names[n]] = segments.empty() ? 0.0 : sum / static_cast<double>(segments.size());
    }
    return rates;
}

}  // namespace ostraka
