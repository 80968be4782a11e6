// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/keypoint_matching.hpp"

#include <algorithm>
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

struct ScanKeypoints {
    std::vector<Vec3f> points;
    std::vector<Mat3f> frames;  // R_scene_keypoint
    std::vector<std::vector<std::uint8_t>> rows;
};

// Integer arithmetic: the same sums whatever vectors the machine has.
__attribute__((target_clones("default", "avx2"))) std::uint32_t squared_row_distance(
    const std::uint8_t* a, const std::uint8_t* b) {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < kShotLength; ++i) {
        const auto difference = static_cast<std::int16_t>(std::int16_t{a[i]} - std::int16_t{b[i]});
        sum += std::int32_t{difference} * std::int32_t{difference};
    }
    return static_cast<std::uint32_t>(sum);
}

ScanKeypoints describe_scan(const Scan& scan, const LibrarySettings& library,
                            const RecognitionSettings& settings) {
    const PointCloud foreground = select(scan.cloud, scan.foreground);
    const CellGrid grid(foreground.points, settings.keypoint_spacing * scan.sampling);
    std::vector<Vec3f> points;
    for (std::size_t c = 0; c < grid.cell_count(); ++c) {
        const auto members = grid.members(c);
        points.push_back(foreground.points[members[members.size() / 2]]);
    }
    // The support leaves the table out, as the library's views have none.
    const KdTree tree(foreground.points);
    const LocalDescriptors described =
        describe_shot(foreground, tree, points,
                      {.radius = static_cast<float>(library.keypoint_radius * library.sampling)});
    ScanKeypoints keypoints;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!described.frames[i].allFinite()) continue;
        keypoints.points.push_back(points[i]);
        keypoints.frames.emplace_back(described.frames[i].transpose());
        keypoints.rows.push_back(quantize_row(
            std::span<const float>(described.rows).subspan(i * kShotLength, kShotLength)));
    }
    return keypoints;
}

}  // namespace

std::vector<std::vector<Correspondence>> match_keypoints(const Scan& scan,
                                                         const ModelLibrary& library,
                                                         const RecognitionSettings& settings) {
    const ScanKeypoints keypoints = describe_scan(scan, library.settings, settings);
    const std::size_t count = keypoints.points.size();
    std::vector<std::vector<Correspondence>> matches(library.models.size());
    for (auto& of_model : matches) of_model.resize(count);
    parallel_for(
        library.models.size() * count,
        [&](std::size_t job) {
            const Keypoints& model = library.models[job / count].keypoints;
            const std::size_t k = job % count;
            std::uint32_t best = std::numeric_limits<std::uint32_t>::max();
            std::size_t best_row = 0;
            for (std::size_t row = 0; row < model.size(); ++row) {
                const std::uint32_t distance = squared_row_distance(
                    keypoints.rows[k].data(), model.rows.data() + row * kShotLength);
                if (distance < best) {
                    best = distance;
                    best_row = row;
                }
            }
            Correspondence& match = matches[job / count][k];
            match.distance = best;
            if (model.size() == 0) return;
            match.scene_point = keypoints.points[k];
            match.model_point = model.points[best_row];
            match.R_scene_model = keypoints.frames[k] * model.frames[best_row].transpose();
        },
        16);
    for (auto& of_model : matches) {
        std::erase_if(of_model, [](const Correspondence& match) {
            return match.distance == std::numeric_limits<std::uint32_t>::max();
        });
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
