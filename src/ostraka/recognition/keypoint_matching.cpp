// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/keypoint_matching.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/registration/rigid_fit.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kGroupSeeds = 120;    // best matches that seed a consistent group
constexpr std::size_t kGroupMatches = 400;  // best matches that may join one
constexpr std::size_t kMinGroup = 3;

}  // namespace

std::vector<std::vector<Correspondence>> match_keypoints(const Scan& scan,
                                                         const LibrarySettings& library,
                                                         const KeypointIndex& index,
                                                         const RecognitionSettings& settings) {
    const auto most = static_cast<std::size_t>(std::max(1, settings.max_keypoints));
    auto matches =
        index.match(scene_keypoints(scan.cloud, library, settings.keypoint_spacing, most));
    for (auto& of_model : matches) {
        std::erase_if(of_model, [](const Correspondence& match) { return !match.matched(); });
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
