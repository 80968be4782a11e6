// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/scale_keypoints.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/local_checks.hpp"
#include "ostraka/descriptors/vertex_rings.hpp"

namespace ostraka {
namespace {

constexpr int kMostLevels = 1000;
constexpr std::size_t kGrain = 256;  // points that a thread takes at a time

// 0 where a point has no ring.
std::vector<double> mean_edges(std::span<const Vec3f> points, const PointLists& rings) {
    std::vector<double> edges(points.size(), 0.0);
    parallel_for(
        points.size(),
        [&](std::size_t i) {
            const auto ring = rings.of(i);
            for (const std::uint32_t neighbor : ring) {
                edges[i] += (points[neighbor] - points[i]).cast<double>().norm() /
                            static_cast<double>(ring.size());
            }
        },
        kGrain);
    return edges;
}

// Moves each vertex to the mean of itself and its ring.
void smooth(const PointLists& rings, const std::vector<Vec3d>& from, std::vector<Vec3d>& to) {
    parallel_for(
        from.size(),
        [&](std::size_t i) {
            const auto ring = rings.of(i);
            Vec3d sum = from[i];
            for (const std::uint32_t neighbor : ring) sum += from[neighbor];
            to[i] = sum / static_cast<double>(ring.size() + 1);
        },
        kGrain);
}

using Responses = std::vector<float>;  // of all points at one level

std::vector<Responses> scale_space(const PointCloud& cloud, const PointLists& rings,
                                   const std::vector<double>& edges, int levels) {
    std::vector<Vec3d> now(cloud.size());
    std::vector<Vec3d> next(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) now[i] = cloud.points[i].cast<double>();
    std::vector<Responses> space;
    for (int level = 1; level <= levels; ++level) {
        smooth(rings, now, next);
        Responses responses(cloud.size(), 0.0F);
        for (std::size_t i = 0; i < cloud.size(); ++i) {
            if (!(edges[i] > 0.0) || !cloud.normals[i].allFinite()) continue;
            const double motion = cloud.normals[i].cast<double>().dot(next[i] - now[i]);
            responses[i] = static_cast<float>(std::abs(motion) * level / edges[i]);
        }
        space.push_back(std::move(responses));
        now.swap(next);
    }
    return space;
}

// Whether no response next to (point, level), in place or scale, is as large.
bool is_extremum(const std::vector<Responses>& space, const PointLists& rings, std::size_t point,
                 std::size_t level) {
    const float response = space[level][point];
    for (std::size_t other = level - 1; other <= level + 1; ++other) {
        if (other != level && space[other][point] >= response) return false;
        for (const std::uint32_t neighbor : rings.of(point)) {
            if (space[other][neighbor] >= response) return false;
        }
    }
    return true;
}

}  // namespace

std::vector<ScaleKeypoint> detect_scale_keypoints(const PointCloud& cloud,
                                                  std::span<const IndexTriangle> triangles,
                                                  const ScaleKeypointSettings& settings) {
    require_surfels(cloud, "scale keypoints");
    require_triangles(triangles, cloud.size(), "scale keypoints");
    if (settings.levels < 3 || settings.levels > kMostLevels || !(settings.contrast >= 0.0F)) {
        throw InvalidInput(
            fmt::format("scale keypoints: {} levels, contrast {:g}; must be 3 to {} "
                        "and not negative",
                        settings.levels, settings.contrast, kMostLevels));
    }
    const PointLists rings = vertex_rings(cloud.points, triangles);
    const std::vector<double> edges = mean_edges(cloud.points, rings);
    const std::vector<Responses> space = scale_space(cloud, rings, edges, settings.levels);
    // A border's influence spreads as the smoothing does, by the square root of the level.
    const int most = 1 + static_cast<int>(std::ceil(std::sqrt(settings.levels)));
    std::vector<int> to_border(cloud.size(), most);
    if (!settings.keep_borders) {
        to_border = border_distances(cloud.points, cloud.normals, rings, most);
    }
    std::vector<ScaleKeypoint> keypoints;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        for (std::size_t s = 1; s + 1 < space.size(); ++s) {
            const int level = static_cast<int>(s) + 1;
            const float response = space[s][i];
            if (!(response > 0.0F) || !(response >= settings.contrast)) continue;
            if (to_border[i] <= std::sqrt(level) || !is_extremum(space, rings, i, s)) continue;
            const auto scale = static_cast<float>(edges[i] * std::sqrt(level));
            keypoints.push_back({i, level, scale, response});
        }
    }
    return keypoints;
}

}  // namespace ostraka
