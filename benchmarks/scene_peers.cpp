// SPDX-License-Identifier: Apache-2.0
#include "scene_peers.hpp"

#include <algorithm>

#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/planes.hpp"
#include "ostraka/cloud/range_smoothing.hpp"
#include "ostraka/cloud/resample.hpp"

namespace ostraka::bench {
namespace {

constexpr double kTableShare = 0.15;   // of the points, at least, lie on a table
constexpr double kTableAcross = 1.2;   // of the largest model's diameter, at least
constexpr double kAgreement = 1.5;     // sampling distances from model to scan
constexpr float kNormalCosine = 0.8F;  // of the angle between normals that agree
constexpr double kExplained = 3.0;     // sampling distances from a found object to its points

double diagonal_of(const PointCloud& cloud, std::span<const std::uint32_t> indices) {
    Eigen::AlignedBox3f box;
    for (const std::uint32_t i : indices) box.extend(cloud.points[i]);
    return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

// Share of the model's points on the sensor's side that lie on the scan.
double agreement(const PointCloud& surface, const Pose& T_scene_model, const PointCloud& scan,
                 const KdTree& tree, double sampling) {
    const auto limit = static_cast<float>(kAgreement * sampling);
    std::size_t facing = 0;
    std::size_t agreeing = 0;
    const Eigen::Isometry3f T = T_scene_model.cast<float>();
    for (std::size_t i = 0; i < surface.size(); ++i) {
        const Vec3f point = T * surface.points[i];
        const Vec3f normal = T.linear() * surface.normals[i];
        if (normal.dot(scan.viewpoint - point) <= 0.0F) continue;
        ++facing;
        const Neighbor nearest = tree.nearest(point);
        if (nearest.index == kNoIndex || nearest.squared_distance > limit * limit) continue;
        if (normal.dot(scan.normals[nearest.index]) > kNormalCosine) ++agreeing;
    }
    return facing == 0 ? 0.0 : static_cast<double>(agreeing) / static_cast<double>(facing);
}

void take_explained(const PointCloud& surface, const Pose& T_scene_model, const PointCloud& scan,
                    double sampling, std::vector<bool>& taken) {
    const KdTree tree(surface.points);
    const auto limit = static_cast<float>(kExplained * sampling);
    const Eigen::Isometry3f T_model_scene = T_scene_model.inverse().cast<float>();
    for (std::size_t i = 0; i < scan.size(); ++i) {
        if (taken[i]) continue;
        const Neighbor nearest = tree.nearest(T_model_scene * scan.points[i]);
        if (nearest.squared_distance < limit * limit) taken[i] = true;
    }
}

}  // namespace

PointCloud peer_scan(const PointCloud& scan, const ModelLibrary& library) {
    const double sampling = library.settings.sampling;
    PointCloud points = scan;
    points.normals.clear();
    points.colors.clear();
    points = resample(smooth_ranges(remove_invalid(points), {.spacing = sampling}), sampling);
    points.normals = estimate_normals_within(points, kNormalRadius * sampling);
    points = remove_invalid(points);
    double largest = 0.0;
    for (const Model& model : library.models) largest = std::max(largest, model.shape.diameter);
    const auto least = static_cast<std::size_t>(kTableShare * static_cast<double>(points.size()));
    const std::optional<Plane> table = find_plane(points, least, {.tolerance = sampling});
    if (!table || diagonal_of(points, table->inliers) < kTableAcross * largest) return points;
    std::vector<std::uint32_t> above;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const double height = table->normal.dot(points.points[i].cast<double>()) - table->offset;
        if (height >= sampling) above.push_back(i);
    }
    return select(points, above);
}

std::vector<int> told_counts(const TestScene& scene, std::size_t models) {
    std::vector<int> counts(models, 0);
    for (const TrueObject& object : scene.objects) {
        if (object.visible_fraction >= MatchSettings{}.min_visible) ++counts[object.model];
    }
    return counts;
}

PointCloud free_points(const PointCloud& scan, const std::vector<bool>& taken) {
    std::vector<std::uint32_t> free;
    for (std::uint32_t i = 0; i < scan.size(); ++i) {
        if (!taken[i]) free.push_back(i);
    }
    return select(scan, free);
}

std::vector<RecognizedObject> find_told(const ScenePeer& peer, const ModelLibrary& library,
                                        const PointCloud& scan, const std::vector<int>& counts) {
    const double sampling = library.settings.sampling;
    std::vector<RecognizedObject> found;
    peer.look(scan);
    for (std::uint32_t m = 0; m < counts.size(); ++m) {
        const Model& model = library.models[m];
        std::vector<bool> taken(scan.size(), false);
        for (int n = 0; n < counts[m]; ++n) {
            const PointCloud free = free_points(scan, taken);
            const KdTree tree(free.points);
            double best = -1.0;
            Pose pose = Pose::Identity();
            for (const Pose& candidate : peer.find(m, taken)) {
                const double score = agreement(model.surface, candidate, free, tree, sampling);
                if (score <= best) continue;
                best = score;
                pose = candidate;
            }
            if (best < 0.0) break;
            found.push_back(
                {.model = model.name, .model_index = m, .T_scene_model = pose, .confidence = 1.0});
            take_explained(model.surface, pose, scan, sampling, taken);
        }
    }
    return found;
}

}  // namespace ostraka::bench
