// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/keypoint_matching.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/cell_grid.hpp"
#include "ostraka/library/keypoints.hpp"
#include "ostraka/registration/rigid_fit.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kGroupSeeds = 120;    // best matches that seed a consistent group
constexpr std::size_t kGroupMatches = 400;  // best matches that may join one
constexpr std::size_t kMinGroup = 3;
constexpr std::size_t kBlock = 16;  // keypoints compared with a model's rows at a time

struct ScanKeypoints {
    std::vector<Vec3f> points;
    std::vector<Mat3f> frames;  // R_scene_keypoint
    WideRows rows;
};

// Integer arithmetic: the same sums whatever vectors the machine has. Rows are widened to 16 bits
// once, so that the products need no unpacking.
__attribute__((target_clones("default", "avx2"))) std::int32_t dot(const std::int16_t* a,
                                                                   const std::int16_t* b) {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < kShotLength; ++i) sum += std::int32_t{a[i]} * std::int32_t{b[i]};
    return sum;
}

ScanKeypoints describe_scan(const Scan& scan, const LibrarySettings& library,
                            const RecognitionSettings& settings) {
    const PointCloud foreground = select(scan.cloud, scan.foreground);
    const CellGrid grid(foreground.points, settings.keypoint_spacing * scan.sampling);
    std::vector<Vec3f> points;
    const std::size_t stride =
        1 + grid.cell_count() / static_cast<std::size_t>(std::max(1, settings.max_keypoints));
    for (std::size_t c = 0; c < grid.cell_count(); c += stride) {
        const auto members = grid.members(c);
        points.push_back(foreground.points[members[members.size() / 2]]);
    }
    // The support leaves the table out, as the library's views have none.
    const KdTree tree(foreground.points);
    const LocalDescriptors described =
        describe_shot(foreground, tree, points,
                      {.radius = static_cast<float>(library.keypoint_radius * library.sampling)});
    ScanKeypoints keypoints;
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

// The nearest model row of each keypoint in [first, last): a row is compared with all of them while
// it is at hand. |a - b|^2 = |a|^2 + |b|^2 - 2 a.b, exactly, in integers.
void match_block(const ScanKeypoints& scan, std::size_t first, std::size_t last,
                 const Keypoints& model, const WideRows& rows,
                 std::vector<Correspondence>& matches) {
    std::array<std::int32_t, kBlock> best;
    std::array<std::size_t, kBlock> best_row{};
    best.fill(std::numeric_limits<std::int32_t>::max());
    for (std::size_t row = 0; row < model.size(); ++row) {
        const std::int16_t* values = rows.values.data() + row * kShotLength;
        for (std::size_t k = first; k < last; ++k) {
            const std::int32_t distance =
                rows.squares[row] - 2 * dot(scan.rows.values.data() + k * kShotLength, values);
            if (distance < best[k - first]) {
                best[k - first] = distance;
                best_row[k - first] = row;
            }
        }
    }
    for (std::size_t k = first; k < last; ++k) {
        if (model.size() == 0) continue;
        const std::size_t row = best_row[k - first];
        matches[k] = {.scene_point = scan.points[k],
                      .model_point = model.points[row],
                      .R_scene_model = scan.frames[k] * model.frames[row].transpose(),
                      .distance = best[k - first] + scan.rows.squares[k]};
    }
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

std::vector<std::vector<Correspondence>> match_keypoints(const Scan& scan,
                                                         const ModelLibrary& library,
                                                         std::span<const WideRows> model_rows,
                                                         const RecognitionSettings& settings) {
    const ScanKeypoints keypoints = describe_scan(scan, library.settings, settings);
    const std::size_t count = keypoints.points.size();
    std::vector<std::vector<Correspondence>> matches(library.models.size());
    for (auto& of_model : matches) of_model.resize(count);
    const std::size_t blocks = (count + kBlock - 1) / kBlock;
    parallel_for(library.models.size() * blocks, [&](std::size_t job) {
        const std::size_t model = job / blocks;
        const std::size_t first = job % blocks * kBlock;
        const std::size_t last = std::min(count, first + kBlock);
        match_block(keypoints, first, last, library.models[model].keypoints, model_rows[model],
                    matches[model]);
    });
    for (auto& of_model : matches) {
        std::erase_if(of_model, [](const Correspondence& match) { return match.distance < 0; });
        std::stable_sort(of_model.begin(), of_model.end(),
                         [](const auto& a, const auto& b) { return a.distance < b.distance; });
    }
    return matches;
}

std::vector<Pose> poses_from_matches(std::span<const Correspondence> matches, double tolerance) {
    std::vector<Pose> poses;
    for (const Correspondence& match : matches) {
        Pose T_scene_model = Pose::Identity();
        T_scene_model.linear() = match.R_scene_model.cast<double>();
        T_scene_model.translation() = match.scene_point.cast<double>() -
                                      T_scene_model.linear() * match.model_point.cast<double>();
        poses.push_back(T_scene_model);
    }
    const std::span<const Correspondence> best =
        matches.first(std::min(kGroupMatches, matches.size()));
    const auto limit = static_cast<float>(tolerance);
    for (std::size_t seed = 0; seed < std::min(kGroupSeeds, best.size()); ++seed) {
        std::vector<Vec3f> model_points = {best[seed].model_point};
        std::vector<Vec3f> scene_points = {best[seed].scene_point};
        for (std::size_t i = 0; i < best.size(); ++i) {
            if (i == seed) continue;
            bool consistent = true;
            for (std::size_t g = 0; g < model_points.size() && consistent; ++g) {
                const float in_model = (best[i].model_point - model_points[g]).norm();
                const float in_scene = (best[i].scene_point - scene_points[g]).norm();
                consistent = std::abs(in_model - in_scene) < limit && in_scene > limit;
            }
            if (!consistent) continue;
            model_points.push_back(best[i].model_point);
            scene_points.push_back(best[i].scene_point);
        }
        if (model_points.size() >= kMinGroup)
            poses.push_back(fit_rigid(model_points, scene_points));
    }
    return poses;
}

}  // namespace ostraka
