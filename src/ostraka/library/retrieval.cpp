// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/retrieval.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/clusters.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/range_smoothing.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/library/bags.hpp"
#include "ostraka/library/consensus.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kScaleSamples = 200;   // entries that a table's scale is measured on
constexpr std::size_t kMostKeypoints = 400;  // of a segment

// The fused score's weights, chosen on scenes of other seeds than those that are reported.
constexpr double kLikenessShare = 0.4;
constexpr double kLikeness = 10.0;  // a model half as far again as the nearest counts exp(-5)

std::vector<float> distances_to_all(const std::vector<float>& rows, std::span<const float> row,
                                    Metric metric) {
    std::vector<float> result(row.empty() ? 0 : rows.size() / row.size());
    for (std::size_t i = 0; i < result.size(); ++i) {
        const auto other = std::span<const float>(rows).subspan(i * row.size(), row.size());
        result[i] = distance(other, row, metric);
    }
    return result;
}

std::vector<float> comparable_rows(std::span<const float> rows, std::size_t length, Metric metric) {
    std::vector<float> result;
    result.reserve(rows.size());
    for (std::size_t i = 0; i < rows.size(); i += length) {
        const std::vector<float> row = comparable_row(rows.subspan(i, length), metric);
        result.insert(result.end(), row.begin(), row.end());
    }
    return result;
}

// Median over entries of the distance to the nearest entry of another model (of any other entry if
// there is one model only).
float table_scale(const ModelLibrary& library, const std::vector<float>& rows, std::size_t length,
                  const std::function<std::vector<float>(std::span<const float>)>& distances) {
    const std::size_t count = library.entries.size();
    const std::size_t stride = 1 + count / kScaleSamples;
    constexpr float kNone = std::numeric_limits<float>::max();
    std::vector<float> nearest((count + stride - 1) / stride, kNone);
    parallel_for(nearest.size(), [&](std::size_t sample) {
        const std::size_t i = sample * stride;
        const auto row = std::span<const float>(rows).subspan(i * length, length);
        const std::vector<float> all = distances(row);
        for (std::size_t j = 0; j < count; ++j) {
            const bool same_model = library.entries[i].model == library.entries[j].model;
            if (i == j || (same_model && library.models.size() > 1)) continue;
            nearest[sample] = std::min(nearest[sample], all[j]);
        }
    });
    std::erase(nearest, kNone);
    if (nearest.empty()) return 1.0F;
    std::sort(nearest.begin(), nearest.end());
    return std::max(nearest[nearest.size() / 2], 1e-6F);
}

PointCloud with_normals(PointCloud cloud, const LibrarySettings& settings) {
    cloud.normals = estimate_normals_within(cloud, kNormalRadius * settings.sampling);
    return remove_invalid(cloud);
}

bool entry_nearer(const EntryMatch& a, const EntryMatch& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.entry < b.entry;
}

// Replaces the scores of a ranking by global descriptors, and sorts anew. Where a piece is too
// small for keypoints the ranking stays.
void add_keypoints(std::span<const double> consensus, bool fuse,
                   std::vector<RankedModel>& ranking) {
    const double highest = *std::max_element(consensus.begin(), consensus.end());
    float nearest = std::numeric_limits<float>::max();
    for (const RankedModel& ranked : ranking) nearest = std::min(nearest, ranked.best.distance);
    for (RankedModel& ranked : ranking) {
        ranked.score = consensus[ranked.model];
        if (!fuse) continue;
        const double agreement = highest > 0.0 ? consensus[ranked.model] / highest : 1.0;
        const double likeness =
            std::exp(kLikeness * (1.0 - double{ranked.best.distance} / std::max(nearest, 1e-6F)));
        ranked.score = (agreement + kLikenessShare * likeness) / (1.0 + kLikenessShare);
    }
    std::stable_sort(ranking.begin(), ranking.end(),
                     [](const auto& a, const auto& b) { return a.score > b.score; });
}

std::vector<double> consensus_of(const EntryIndex& index, const PointCloud& cloud) {
    const LibrarySettings& settings = index.library().settings;
    const SceneKeypoints scene =
        scene_keypoints(cloud, settings, settings.keypoint_spacing, kMostKeypoints);
    return keypoint_consensus(index.keypoints().match(scene), settings.sampling);
}

std::size_t table_number(const ModelLibrary& library, std::string_view descriptor) {
    for (std::size_t t = 0; t < library.tables.size(); ++t) {
        if (descriptor_name(library.tables[t].descriptor) == descriptor) return t;
    }
    throw InvalidInput(fmt::format("the library has no descriptor {}", descriptor));
}

}  // namespace

EntryIndex::EntryIndex(const ModelLibrary& library, std::optional<Metric> metric)
    : library_(&library),
      metrics_(library.tables.size()),
      rows_(library.tables.size()),
      spreads_(library.tables.size()),
      scales_(library.tables.size()),
      keypoints_(library) {
    parallel_for(library.tables.size(), [&](std::size_t t) {
        const DescriptorTable& table = library.tables[t];
        const std::size_t length = descriptor_length(table.descriptor);
        metrics_[t] = metric.value_or(best_metric(table.descriptor));
        rows_[t] = comparable_rows(table.rows, length, metrics_[t]);
        if (!table.spread.empty() && metrics_[t] == best_metric(table.descriptor)) {
            spreads_[t] = SpreadIndex(table.spread, length);
        }
        scales_[t] = table_scale(library, rows_[t], length,
                                 [&](std::span<const float> row) { return to_all(t, row); });
    });
    bags_ = comparable_rows(library.bags, library.codebook.size(), Metric::hellinger);
}

std::vector<float> EntryIndex::distances(std::size_t table, std::span<const float> row) const {
    return to_all(table, comparable_row(row, metrics_[table]));
}

std::vector<float> EntryIndex::to_all(std::size_t table, std::span<const float> row) const {
    if (!spreads_[table].empty()) return spreads_[table].distances(row);
    return distances_to_all(rows_[table], row, metrics_[table]);
}

std::vector<float> EntryIndex::fused(std::span<const std::vector<float>> distances) const {
    std::vector<float> sum(library_->entries.size(), 0.0F);
    for (std::size_t t = 0; t < distances.size(); ++t) {
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += distances[t][i] / scales_[t];
    }
    return sum;
}

std::vector<float> EntryIndex::fused_distances(const PointCloud& cloud) const {
    std::vector<std::vector<float>> all(rows_.size());
    for (std::size_t t = 0; t < rows_.size(); ++t) {
        all[t] = distances(t, describe(cloud, library_->tables[t].descriptor));
    }
    return fused(all);
}

std::vector<float> EntryIndex::bag_distances(const PointCloud& cloud) const {
    if (bags_.empty()) throw InvalidInput("the library has no codebook for a bag of words");
    const std::vector<float> bag = describe_bag(cloud, *library_, kSegmentBagKeypoints);
    return distances_to_all(bags_, comparable_row(bag, Metric::hellinger), Metric::hellinger);
}

std::vector<EntryMatch> nearest_entries(std::span<const float> distances, std::size_t k) {
    std::vector<EntryMatch> matches(distances.size());
    for (std::uint32_t i = 0; i < matches.size(); ++i) matches[i] = {i, distances[i]};
    k = std::min(k, matches.size());
    std::partial_sort(matches.begin(), matches.begin() + static_cast<std::ptrdiff_t>(k),
                      matches.end(), entry_nearer);
    matches.resize(k);
    return matches;
}

std::vector<RankedModel> rank_models(const ModelLibrary& library, std::span<const float> distances,
                                     std::size_t k) {
    std::vector<RankedModel> ranking(library.models.size());
    for (std::uint32_t i = 0; i < distances.size(); ++i) {
        RankedModel& ranked = ranking[library.entries[i].model];
        ranked.model = library.entries[i].model;
        const EntryMatch match{i, distances[i]};
        if (ranked.best.entry == kNoIndex || entry_nearer(match, ranked.best)) ranked.best = match;
    }
    std::erase_if(ranking, [](const RankedModel& ranked) { return ranked.model == kNoIndex; });
    const std::vector<EntryMatch> nearest = nearest_entries(distances, k);
    for (const EntryMatch& match : nearest) {
        for (RankedModel& ranked : ranking) {
            if (ranked.model == library.entries[match.entry].model) ++ranked.votes;
        }
    }
    for (RankedModel& ranked : ranking) {
        ranked.score = nearest.empty() ? 0.0 : double(ranked.votes) / double(nearest.size());
    }
    std::stable_sort(ranking.begin(), ranking.end(), [](const auto& a, const auto& b) {
        return a.votes != b.votes ? a.votes > b.votes : entry_nearer(a.best, b.best);
    });
    return ranking;
}

PreparedSegment prepare_segment(const PointCloud& segment, const LibrarySettings& settings) {
    PreparedSegment prepared;
    const PointCloud cloud =
        resample(smooth_ranges(segment, {.spacing = settings.sampling}), settings.sampling);
    if (cloud.empty()) return prepared;
    prepared.whole = with_normals(cloud, settings);
    prepared.piece = prepared.whole;
    if (settings.full_views_only) return prepared;
    const Clusters clusters = euclidean_clusters(cloud.points, settings.cuts.cluster_tolerance);
    // Normals are worked out within the piece: what lies beyond a gap is not part of it.
    if (clusters.size() > 1) {
        prepared.piece = with_normals(select(cloud, clusters.front()), settings);
    }
    return prepared;
}

SegmentEvidence gather_evidence(const EntryIndex& index, const PreparedSegment& segment) {
    if (segment.empty()) throw InvalidInput("the segment has fewer than 3 points");
    SegmentEvidence evidence;
    for (std::size_t t = 0; t < index.library().tables.size(); ++t) {
        const AnyDescriptor& descriptor = index.library().tables[t].descriptor;
        evidence.distances.push_back(index.distances(t, describe(segment.piece, descriptor)));
    }
    evidence.consensus = consensus_of(index, segment.whole);
    return evidence;
}

std::vector<RankedModel> rank_models(const EntryIndex& index, const SegmentEvidence& evidence,
                                     std::string_view descriptor, std::size_t k) {
    const ModelLibrary& library = index.library();
    if (descriptor != "fused" && descriptor != "keypoints") {
        return rank_models(library, evidence.distances[table_number(library, descriptor)], k);
    }
    auto ranking = rank_models(library, index.fused(evidence.distances), k);
    add_keypoints(evidence.consensus, descriptor == "fused", ranking);
    return ranking;
}

std::vector<RankedModel> classify(const EntryIndex& index, const PreparedSegment& segment,
                                  std::string_view descriptor, std::size_t k) {
    const ModelLibrary& library = index.library();
    if (descriptor == "fused" || descriptor == "keypoints") {
        return rank_models(index, gather_evidence(index, segment), descriptor, k);
    }
    if (segment.empty()) throw InvalidInput("the segment has fewer than 3 points");
    if (descriptor == kBagOfWords) {
        return rank_models(library, index.bag_distances(segment.piece), k);
    }
    const std::size_t table = table_number(library, descriptor);
    const auto row = describe(segment.piece, library.tables[table].descriptor);
    return rank_models(library, index.distances(table, row), k);
}

}  // namespace ostraka
