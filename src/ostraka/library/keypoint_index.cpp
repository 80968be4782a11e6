// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/keypoint_index.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/cell_grid.hpp"
#include "ostraka/library/keypoints.hpp"
#include "ostraka/library/neighbor_graph.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kGraphBreadth = 96;  // recall .99 of a million rows
constexpr std::size_t kBlock = 16;         // keypoints compared with a model's rows at a time

// Integer arithmetic: the same sums whatever vectors the machine has. Rows are widened to 16 bits
// once, so that the products need no unpacking.
__attribute__((target_clones("default", "avx2"))) std::int32_t dot(const std::int16_t* a,
                                                                   const std::int16_t* b) {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < kShotLength; ++i) sum += std::int32_t{a[i]} * std::int32_t{b[i]};
    return sum;
}

// The nearest model row of each keypoint in [first, last): a row is compared with all of them while
// it is at hand. |a - b|^2 = |a|^2 + |b|^2 - 2 a.b, exactly, in integers.
void match_block(const SceneKeypoints& scene, std::size_t first, std::size_t last,
                 const Keypoints& model, const WideRows& rows,
                 std::vector<Correspondence>& matches) {
    std::array<std::int32_t, kBlock> best;
    std::array<std::size_t, kBlock> best_row{};
    best.fill(std::numeric_limits<std::int32_t>::max());
    for (std::size_t row = 0; row < model.size(); ++row) {
        const std::int16_t* values = rows.values.data() + row * kShotLength;
        for (std::size_t k = first; k < last; ++k) {
            const std::int32_t distance =
                rows.squares[row] - 2 * dot(scene.rows.values.data() + k * kShotLength, values);
            if (distance < best[k - first]) {
                best[k - first] = distance;
                best_row[k - first] = row;
            }
        }
    }
    for (std::size_t k = first; k < last; ++k) {
        const std::size_t row = best_row[k - first];
        matches[k] = {.scene_point = scene.points[k],
                      .model_point = model.points[row],
                      .R_scene_model = scene.frames[k] * model.frames[row].transpose(),
                      .distance = best[k - first] + scene.rows.squares[k]};
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

WideRows widen(std::span<const std::uint8_t> rows) {
    WideRows wide;
    wide.values.assign(rows.begin(), rows.end());
    wide.squares.resize(rows.size() / kShotLength);
    for (std::size_t i = 0; i < wide.squares.size(); ++i) {
        const std::int16_t* row = wide.values.data() + i * kShotLength;
        wide.squares[i] = dot(row, row);
    }
    return wide;
}

SceneKeypoints scene_keypoints(const PointCloud& cloud, const LibrarySettings& settings,
                               double spacing, std::size_t most) {
    const std::vector<Vec3f> points = spread(cloud, spacing * settings.sampling, most);
    const auto radius = static_cast<float>(settings.keypoint_radius * settings.sampling);
    const LocalDescriptors described = describe_shot(cloud, points, {.radius = radius});
    SceneKeypoints keypoints;
    std::vector<std::uint8_t> rows;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!described.frames[i].allFinite()) continue;
        keypoints.points.push_back(points[i]);
        keypoints.frames.emplace_back(described.frames[i].transpose());
        const std::vector<std::uint8_t> row = quantize_row(
            std::span<const float>(described.rows).subspan(i * kShotLength, kShotLength));
        rows.insert(rows.end(), row.begin(), row.end());
    }
    keypoints.rows = widen(rows);
    return keypoints;
}

KeypointIndex::KeypointIndex(const ModelLibrary& library) : library_(&library) {
    if (library.keypoint_graph.links.empty()) {
        rows_.resize(library.models.size());
        parallel_for(rows_.size(),
                     [&](std::size_t m) { rows_[m] = widen(library.models[m].keypoints.rows); });
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
    const std::size_t blocks = (count + kBlock - 1) / kBlock;
    parallel_for(rows_.size() * blocks, [&](std::size_t job) {
        const std::size_t model = job / blocks;
        if (matches[model].empty()) return;
        const std::size_t first = job % blocks * kBlock;
        const std::size_t last = std::min(count, first + kBlock);
        match_block(scene, first, last, library_->models[model].keypoints, rows_[model],
                    matches[model]);
    });
}

void KeypointIndex::match_by_graph(const SceneKeypoints& scene,
                                   std::vector<std::vector<Correspondence>>& matches) const {
    const ByteRows rows{bytes_, kShotLength};
    parallel_for(scene.size(), [&](std::size_t k) {
        thread_local SearchScratch scratch;
        thread_local std::vector<std::uint8_t> query;
        const auto wide = scene.rows.values.begin() + static_cast<std::ptrdiff_t>(k * kShotLength);
        query.assign(wide, wide + kShotLength);
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
