// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/keypoints.hpp"

#include <algorithm>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/cell_grid.hpp"

namespace ostraka {
namespace {

constexpr float kMinFacing = 0.35F;  // cosine between normal and line of sight: not seen edge-on

struct Sighting {
    float facing = 0.0F;
    std::size_t view = 0;
};

// The surface point nearest to the mean of each cell.
std::vector<std::uint32_t> spread_keypoints(const PointCloud& surface, double spacing) {
    const CellGrid grid(surface.points, spacing);
    std::vector<std::uint32_t> chosen;
    for (std::size_t c = 0; c < grid.cell_count(); ++c) {
        Vec3d mean = Vec3d::Zero();
        for (const std::uint32_t i : grid.members(c)) mean += surface.points[i].cast<double>();
        mean /= static_cast<double>(grid.members(c).size());
        const auto members = grid.members(c);
        chosen.push_back(*std::min_element(
            members.begin(), members.end(), [&](std::uint32_t a, std::uint32_t b) {
                return (surface.points[a].cast<double>() - mean).squaredNorm() <
                       (surface.points[b].cast<double>() - mean).squaredNorm();
            }));
    }
    return chosen;
}

// The views that show a surface point, most frontal first.
std::vector<Sighting> sightings(const Vec3f& point, const Vec3f& normal,
                                std::span<const ModelView> views, std::span<const KdTree> trees,
                                double sampling) {
    std::vector<Sighting> result;
    for (std::size_t v = 0; v < views.size(); ++v) {
        const float facing = normal.dot((views[v].cloud.viewpoint - point).normalized());
        if (facing < kMinFacing) continue;
        const Neighbor nearest = trees[v].nearest(point);
        if (nearest.index == kNoIndex || nearest.squared_distance > sampling * sampling) continue;
        if (views[v].cloud.normals[nearest.index].dot(normal) < 0.5F) continue;
        result.push_back({facing, v});
    }
    std::stable_sort(result.begin(), result.end(),
                     [](const Sighting& a, const Sighting& b) { return a.facing > b.facing; });
    return result;
}

}  // namespace

std::vector<std::uint8_t> quantize_row(std::span<const float> row) {
    std::vector<std::uint8_t> quantized(row.size());
    for (std::size_t i = 0; i < row.size(); ++i) {
        quantized[i] = static_cast<std::uint8_t>(std::clamp(512.0F * row[i] + 0.5F, 0.0F, 255.0F));
    }
    return quantized;
}

std::vector<std::uint8_t> all_keypoint_rows(const ModelLibrary& library) {
    std::vector<std::uint8_t> rows;
    for (const Model& model : library.models) {
        rows.insert(rows.end(), model.keypoints.rows.begin(), model.keypoints.rows.end());
    }
    return rows;
}

Keypoints describe_keypoints(const PointCloud& surface, std::span<const ModelView> views,
                             const LibrarySettings& settings) {
    std::vector<KdTree> trees;
    for (const ModelView& view : views) trees.emplace_back(view.cloud.points);
    std::vector<std::vector<Vec3f>> points_of_view(views.size());
    const double spacing = settings.keypoint_spacing * settings.sampling;
    for (const std::uint32_t i : spread_keypoints(surface, spacing)) {
        const std::vector<Sighting> seen =
            sightings(surface.points[i], surface.normals[i], views, trees, settings.sampling);
        if (seen.empty()) continue;
        std::vector<std::size_t> ranks = {0, seen.size() / 2, seen.size() - 1};
        ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
        for (const std::size_t rank : ranks) {
            points_of_view[seen[rank].view].push_back(surface.points[i]);
        }
    }
    const ShotSettings shot{.radius =
                                static_cast<float>(settings.keypoint_radius * settings.sampling)};
    std::vector<LocalDescriptors> described(views.size());
    parallel_for(views.size(), [&](std::size_t v) {
        described[v] = describe_shot(views[v].cloud, trees[v], points_of_view[v], shot);
    });
    Keypoints keypoints;
    for (std::size_t v = 0; v < views.size(); ++v) {
        for (std::size_t k = 0; k < points_of_view[v].size(); ++k) {
            if (!described[v].frames[k].allFinite()) continue;
            keypoints.points.push_back(points_of_view[v][k]);
            keypoints.frames.emplace_back(described[v].frames[k].transpose());
            const std::vector<std::uint8_t> row = quantize_row(
                std::span<const float>(described[v].rows).subspan(k * kShotLength, kShotLength));
            keypoints.rows.insert(keypoints.rows.end(), row.begin(), row.end());
        }
    }
    return keypoints;
}

}  // namespace ostraka
