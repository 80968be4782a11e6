// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/keypoint_index.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/cell_grid.hpp"
#include "ostraka/library/keypoints.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kBlock = 16;  // keypoints compared with a model's rows at a time

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

KeypointIndex::KeypointIndex(const ModelLibrary& library)
    : library_(&library), rows_(library.models.size()) {
    parallel_for(rows_.size(),
                 [&](std::size_t m) { rows_[m] = widen(library.models[m].keypoints.rows); });
}

std::vector<std::vector<Correspondence>> KeypointIndex::match(const SceneKeypoints& scene) const {
    const std::size_t count = scene.size();
    std::vector<std::vector<Correspondence>> matches(rows_.size());
    for (std::size_t m = 0; m < matches.size(); ++m) {
        if (library_->models[m].keypoints.size() > 0) matches[m].resize(count);
    }
    const std::size_t blocks = (count + kBlock - 1) / kBlock;
    parallel_for(rows_.size() * blocks, [&](std::size_t job) {
        const std::size_t model = job / blocks;
        if (matches[model].empty()) return;
        const std::size_t first = job % blocks * kBlock;
        const std::size_t last = std::min(count, first + kBlock);
        match_block(scene, first, last, library_->models[model].keypoints, rows_[model],
                    matches[model]);
    });
    return matches;
}

}  // namespace ostraka
