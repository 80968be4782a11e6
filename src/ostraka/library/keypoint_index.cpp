// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/keypoint_index.hpp"

#include <algorithm>
#include <array>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/cell_grid.hpp"
#include "ostraka/library/keypoints.hpp"
#include "ostraka/library/neighbor_graph.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kGraphBreadth = 96;  // recall .99 of a million rows

// The nearest model row of each keypoint in [first, last).
void match_block(const SceneKeypoints& scene, std::size_t first, std::size_t last,
                 const Keypoints& model, const RowTable& rows,
                 std::vector<Correspondence>& matches) {
    std::array<NearestRow, kQueryBlock> nearest;
    rows.nearest(std::span(scene.rows).subspan(first * kShotLength, (last - first) * kShotLength),
                 nearest.data());
    for (std::size_t k = first; k < last; ++k) {
        const auto& [row, distance] = nearest[k - first];
        matches[k] = {.scene_point = scene.points[k],
                      .model_point = model.points[row],
                      .R_scene_model = scene.frames[k] * model.frames[row].transpose(),
                      .distance = distance};
    }
}

std::vector<Vec3f> spread(const PointCloud& cloud, double spacing, std::size_t most) {
    const CellGrid grid(cloud.points, spacing);
    const std::size_t stride = 1 + grid.cell_count() / std::max<std::size_t>(1, most);
    std::vector<Vec3f> points;
    for (std::size_t c = 0; c < grid.cell_count(); c += stride) {
        const auto members = grid.members(c);
        points.push_back(cloud.points[members[members.size() / 2]]);
    }
    return points;
}

}  // namespace

SceneKeypoints scene_keypoints(const PointCloud& cloud, const LibrarySettings& settings,
                               double spacing, std::size_t most) {
    const std::vector<Vec3f> points = spread(cloud, spacing * settings.sampling, most);
    const auto radius = static_cast<float>(settings.keypoint_radius * settings.sampling);
    const LocalDescriptors described = describe_shot(cloud, points, {.radius = radius});
    SceneKeypoints keypoints;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!described.frames[i].allFinite()) continue;
        keypoints.points.push_back(points[i]);
        keypoints.frames.emplace_back(described.frames[i].transpose());
        const std::vector<std::uint8_t> row = quantize_row(
            std::span<const float>(described.rows).subspan(i * kShotLength, kShotLength));
        keypoints.rows.insert(keypoints.rows.end(), row.begin(), row.end());
    }
    return keypoints;
}

KeypointIndex::KeypointIndex(const ModelLibrary& library) : library_(&library) {
    if (library.keypoint_graph.links.empty()) {
        rows_.resize(library.models.size());
        parallel_for(rows_.size(),
                     [&](std::size_t m) { rows_[m] = RowTable(library.models[m].keypoints.rows); });
        return;
    }
    bytes_ = all_keypoint_rows(library);
    first_rows_.push_back(0);
    for (const Model& model : library.models) {
        const auto count = static_cast<std::uint32_t>(model.keypoints.size());
        first_rows_.push_back(first_rows_.back() + count);
    }
}

std::vector<std::vector<Correspondence>> KeypointIndex::match(const SceneKeypoints& scene) const {
    std::vector<std::vector<Correspondence>> matches(library_->models.size());
    for (std::size_t m = 0; m < matches.size(); ++m) {
        if (library_->models[m].keypoints.size() > 0) matches[m].resize(scene.size());
    }
    if (bytes_.empty()) {
        match_exactly(scene, matches);
    } else {
        match_by_graph(scene, matches);
    }
    return matches;
}

void KeypointIndex::match_exactly(const SceneKeypoints& scene,
                                  std::vector<std::vector<Correspondence>>& matches) const {
    const std::size_t count = scene.size();
    const std::size_t blocks = (count + kQueryBlock - 1) / kQueryBlock;
    parallel_for(rows_.size() * blocks, [&](std::size_t job) {
        const std::size_t model = job / blocks;
        if (matches[model].empty()) return;
        const std::size_t first = job % blocks * kQueryBlock;
        const std::size_t last = std::min(count, first + kQueryBlock);
        match_block(scene, first, last, library_->models[model].keypoints, rows_[model],
                    matches[model]);
    });
}

void KeypointIndex::match_by_graph(const SceneKeypoints& scene,
                                   std::vector<std::vector<Correspondence>>& matches) const {
    const ByteRows rows{bytes_, kShotLength};
    parallel_for(scene.size(), [&](std::size_t k) {
        thread_local SearchScratch scratch;
        const auto query = std::span(scene.rows).subspan(k * kShotLength, kShotLength);
        for (const RowMatch& found : search_graph(library_->keypoint_graph, rows, query,
                                                  kGraphMatches, kGraphBreadth, scratch)) {
            const auto after = std::upper_bound(first_rows_.begin(), first_rows_.end(), found.row);
            const auto m = static_cast<std::size_t>(after - first_rows_.begin()) - 1;
            if (matches[m][k].matched()) continue;  // nearest first
            const Keypoints& model = library_->models[m].keypoints;
            const std::size_t row = found.row - first_rows_[m];
            matches[m][k] = {.scene_point = scene.points[k],
                             .model_point = model.points[row],
                             .R_scene_model = scene.frames[k] * model.frames[row].transpose(),
                             .distance = found.distance};
        }
    });
}

}  // namespace ostraka
