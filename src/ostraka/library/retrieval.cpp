// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/retrieval.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/clusters.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/resample.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kScaleSamples = 200;  // entries that a table's scale is measured on

// Signed square roots of a row scaled to an absolute sum of 1.
std::vector<float> rooted(std::span<const float> row) {
    double sum = 0.0;
    for (const float value : row) sum += std::abs(double{value});
    const double scale = sum > 0.0 ? 1.0 / sum : 0.0;
    std::vector<float> result(row.size());
    for (std::size_t i = 0; i < row.size(); ++i) {
        const double value = std::sqrt(std::abs(double{row[i]}) * scale);
        result[i] = static_cast<float>(row[i] < 0.0F ? -value : value);
    }
    return result;
}

// Eight partial sums in a fixed order, so that the compiler may vectorize and the bits stay the
// same.
float squared_distance(const float* a, const float* b, std::size_t length) {
    std::array<float, 8> sums{};
    std::size_t i = 0;
    for (; i + 8 <= length; i += 8) {
        for (std::size_t lane = 0; lane < 8; ++lane) {
            const float difference = a[i + lane] - b[i + lane];
            sums[lane] += difference * difference;
        }
    }
    for (; i < length; ++i) sums[i % 8] += (a[i] - b[i]) * (a[i] - b[i]);
    return ((sums[0] + sums[4]) + (sums[2] + sums[6])) +
           ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

std::vector<float> distances_to_all(const std::vector<float>& rows, const float* row,
                                    std::size_t length) {
    std::vector<float> result(length > 0 ? rows.size() / length : 0);
    for (std::size_t i = 0; i < result.size(); ++i) {
        result[i] = std::sqrt(squared_distance(rows.data() + i * length, row, length));
    }
    return result;
}

// Median over entries of the distance to the nearest entry of another model (of any other entry if
// there is one model only).
float table_scale(const ModelLibrary& library, const std::vector<float>& rows, std::size_t length) {
    const std::size_t count = library.entries.size();
    const std::size_t stride = 1 + count / kScaleSamples;
    std::vector<float> nearest;
    for (std::size_t i = 0; i < count; i += stride) {
        const std::vector<float> all = distances_to_all(rows, rows.data() + i * length, length);
        float best = std::numeric_limits<float>::max();
        for (std::size_t j = 0; j < count; ++j) {
            const bool same_model = library.entries[i].model == library.entries[j].model;
            if (i == j || (same_model && library.models.size() > 1)) continue;
            best = std::min(best, all[j]);
        }
        if (best < std::numeric_limits<float>::max()) nearest.push_back(best);
    }
    if (nearest.empty()) return 1.0F;
    std::sort(nearest.begin(), nearest.end());
    return std::max(nearest[nearest.size() / 2], 1e-6F);
}

bool nearer(const EntryMatch& a, const EntryMatch& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.entry < b.entry;
}

}  // namespace

EntryIndex::EntryIndex(const ModelLibrary& library)
    : library_(&library), rows_(library.tables.size()), scales_(library.tables.size()) {
    parallel_for(library.tables.size(), [&](std::size_t t) {
        const DescriptorTable& table = library.tables[t];
        const std::size_t length = descriptor_length(table.descriptor);
        rows_[t].reserve(table.rows.size());
        for (std::size_t i = 0; i < library.entries.size(); ++i) {
            const std::vector<float> row =
                rooted(std::span<const float>(table.rows).subspan(i * length, length));
            rows_[t].insert(rows_[t].end(), row.begin(), row.end());
        }
        scales_[t] = table_scale(library, rows_[t], length);
    });
}

std::vector<float> EntryIndex::distances(std::size_t table, std::span<const float> row) const {
    const std::vector<float> query = rooted(row);
    return distances_to_all(rows_[table], query.data(), query.size());
}

std::vector<float> EntryIndex::fused_distances(const PointCloud& cloud) const {
    std::vector<float> sum(library_->entries.size(), 0.0F);
    for (std::size_t t = 0; t < rows_.size(); ++t) {
        const std::vector<float> one =
            distances(t, describe(cloud, library_->tables[t].descriptor));
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += one[i] / scales_[t];
    }
    return sum;
}

std::vector<EntryMatch> nearest_entries(std::span<const float> distances, std::size_t k) {
    std::vector<EntryMatch> matches(distances.size());
    for (std::uint32_t i = 0; i < matches.size(); ++i) matches[i] = {i, distances[i]};
    k = std::min(k, matches.size());
    std::partial_sort(matches.begin(), matches.begin() + static_cast<std::ptrdiff_t>(k),
                      matches.end(), nearer);
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
        if (ranked.best.entry == kNoIndex || nearer(match, ranked.best)) ranked.best = match;
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
        return a.votes != b.votes ? a.votes > b.votes : nearer(a.best, b.best);
    });
    return ranking;
}

PointCloud prepare_segment(const PointCloud& segment, const LibrarySettings& settings) {
    PointCloud cloud = segment;
    cloud.normals.clear();
    cloud = resample(cloud, settings.sampling);
    if (cloud.empty()) return cloud;
    if (!settings.full_views_only) {
        const Clusters clusters = euclidean_clusters(cloud.points, settings.cuts.cluster_tolerance);
        cloud = select(cloud, clusters.front());
    }
    cloud.normals = estimate_normals_within(cloud, kNormalRadius * settings.sampling);
    return remove_invalid(cloud);
}

std::vector<RankedModel> classify(const EntryIndex& index, const PointCloud& segment,
                                  std::string_view descriptor, std::size_t k) {
    const ModelLibrary& library = index.library();
    if (descriptor == "fused") {
        return rank_models(library, index.fused_distances(segment), k);
    }
    for (std::size_t t = 0; t < library.tables.size(); ++t) {
        const AnyDescriptor& candidate = library.tables[t].descriptor;
        if (descriptor_name(candidate) != descriptor) continue;
        return rank_models(library, index.distances(t, describe(segment, candidate)), k);
    }
    throw InvalidInput(fmt::format("the library has no descriptor {}", descriptor));
}

}  // namespace ostraka
