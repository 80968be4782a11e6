// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/segment_matching.hpp"

#include <algorithm>

#include "ostraka/base/parallel.hpp"
#include "ostraka/segmentation/segments.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kMaxOfKind = 12;  // segments; the largest

std::vector<Hypothesis> hypotheses_of(const PointCloud& segment, const EntryIndex& index,
                                      const RecognitionSettings& settings) {
    const PrincipalFrame frame = principal_frame(segment);
    const std::vector<float> distances = index.fused_distances(segment);
    std::vector<Hypothesis> hypotheses;
    const auto k = static_cast<std::size_t>(settings.segment_matches);
    for (const EntryMatch& match : nearest_entries(distances, k)) {
        const Entry& entry = index.library().entries[match.entry];
        const Pose T_entry_model = entry.frame.T_cloud_frame.inverse();
        // An ambiguity of either side shows as a turn about the shortest axis of the segment.
        PrincipalFrame either = frame;
        either.ambiguous_sign = frame.ambiguous_sign || entry.frame.ambiguous_sign;
        either.ambiguous_order = frame.ambiguous_order || entry.frame.ambiguous_order;
        for (const Pose& T_scene_entry : possible_frames(either)) {
            hypotheses.push_back({.model = entry.model,
                                  .T_scene_model = T_scene_entry * T_entry_model,
                                  .source = HypothesisSource::segment});
        }
    }
    return hypotheses;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> segment_scan(const Scan& scan, std::size_t min_points) {
    std::vector<std::uint32_t> left;
    for (std::uint32_t i = 0; i < scan.cloud.size(); ++i) {
        if (scan.explained.empty() || !scan.explained[i]) left.push_back(i);
    }
    SegmentationSettings settings;
    settings.patches.sampling = scan.sampling;
    settings.min_points = min_points;
    settings.max_of_kind = kMaxOfKind;
    std::vector<std::vector<std::uint32_t>> segments;
    for (Segment& segment : segment_hierarchy(scan.cloud, left, settings)) {
        segments.push_back(std::move(segment.indices));
    }
    return segments;
}

std::vector<Hypothesis> hypotheses_from_segments(const Scan& scan, const EntryIndex& index,
                                                 const RecognitionSettings& settings) {
    const std::size_t min_points = index.library().settings.cuts.min_points;
    const auto segments = segment_scan(scan, min_points);
    std::vector<std::vector<Hypothesis>> of_segment(segments.size());
    parallel_for(segments.size(), [&](std::size_t s) {
        of_segment[s] = hypotheses_of(select(scan.cloud, segments[s]), index, settings);
    });
    std::vector<Hypothesis> all;
    for (const auto& some : of_segment) all.insert(all.end(), some.begin(), some.end());
    return all;
}

}  // namespace ostraka
