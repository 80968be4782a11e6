// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/segments.hpp"

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/resample.hpp"

namespace ostraka {
namespace {

std::vector<LabeledSegment> segments_of(const SimulatedScene& scene, double sampling,
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
        LabeledSegment segment{truth.model, truth.visible_fraction, {}};
        segment.cloud = resample(select(scene.cloud, pixels), sampling);
        segment.cloud.normals = estimate_normals_within(segment.cloud, kNormalRadius * sampling);
        segment.cloud = remove_invalid(segment.cloud);
        if (segment.cloud.size() >= settings.min_points) segments.push_back(std::move(segment));
    }
    return segments;
}

}  // namespace

std::vector<LabeledSegment> simulate_segments(const SceneModels& models, double sampling,
                                              const SegmentSettings& settings,
                                              const Progress& progress) {
    std::vector<LabeledSegment> all;
    for (int i = 0; i < settings.scenes; ++i) {
        const SimulatedScene scene =
            simulate_random_view(models, static_cast<std::uint64_t>(i), settings.views);
        for (LabeledSegment& segment : segments_of(scene, sampling, settings)) {
            all.push_back(std::move(segment));
        }
        report(progress, "scenes", static_cast<std::size_t>(i + 1),
               static_cast<std::size_t>(settings.scenes));
    }
    return all;
}

std::map<std::string, double> recognition_rates(const EntryIndex& index,
                                                std::span<const LabeledSegment> segments,
                                                std::size_t k) {
    std::vector<std::string> names = {"fused"};
    for (const DescriptorTable& table : index.library().tables) {
        names.emplace_back(descriptor_name(table.descriptor));
    }
    std::map<std::string, double> rates;
    for (const std::string& name : names) {
        std::vector<int> right(segments.size(), 0);
        parallel_for(segments.size(), [&](std::size_t s) {
            const auto ranking = classify(index, segments[s].cloud, name, k);
            right[s] = !ranking.empty() && ranking.front().model == segments[s].model ? 1 : 0;
        });
        double sum = 0.0;
        for (const int value : right) sum += value;
        rates[name] = segments.empty() ? 0.0 : sum / static_cast<double>(segments.size());
    }
    return rates;
}

}  // namespace ostraka
