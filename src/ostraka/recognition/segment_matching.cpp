// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/segment_matching.hpp"

#include <algorithm>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/clusters.hpp"

namespace ostraka {
namespace {

constexpr double kClusterGap = 2.5;  // sampling distances
constexpr double kSmoothGap = 2.0;   // sampling distances
constexpr std::size_t kMaxSegments = 60;

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
    const PointCloud foreground = select(scan.cloud, scan.foreground);
    Clusters clusters =
        euclidean_clusters(foreground.points, kClusterGap * scan.sampling, min_points);
    const SmoothnessSettings smoothness{.tolerance = kSmoothGap * scan.sampling,
                                        .max_angle = 0.35,
                                        .max_curvature = 0.06,
                                        .min_size = min_points};
    for (auto& cluster : smooth_clusters(foreground, smoothness)) {
        if (std::find(clusters.begin(), clusters.end(), cluster) == clusters.end()) {
            clusters.push_back(std::move(cluster));
        }
    }
    if (clusters.size() > kMaxSegments) clusters.resize(kMaxSegments);
    for (auto& cluster : clusters) {
        for (std::uint32_t& i : cluster) i = scan.foreground[i];
    }
    return clusters;
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
