// SPDX-License-Identifier: Apache-2.0
#include "ostraka/subparts/cuts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/clusters.hpp"

namespace ostraka {
std::vector<Vec3d> cut_directions(int count) {
    if (count != 6 && count != 14 && count != 26) {
        throw InvalidInput(fmt::format("{} cut directions: 6, 14 or 26 are possible", count));
    }
    std::vector<Vec3d> axes;
    std::vector<Vec3d> edges;
    std::vector<Vec3d> corners;
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) {
                const int steps = std::abs(x) + std::abs(y) + std::abs(z);
                if (steps == 0) continue;
                auto& group = steps == 1 ? axes : (steps == 2 ? edges : corners);
                group.push_back(Vec3d(x, y, z).normalized());
            }
        }
    }
    std::vector<Vec3d> directions = axes;
    if (count >= 14) directions.insert(directions.end(), corners.begin(), corners.end());
    if (count >= 26) directions.insert(directions.end(), edges.begin(), edges.end());
    return directions;
}

std::vector<std::uint32_t> cut_below(const PointCloud& cloud, const Vec3d& direction,
                                     double fraction) {
    const Vec3f axis = direction.cast<float>();
    float low = std::numeric_limits<float>::max();
    float high = std::numeric_limits<float>::lowest();
    for (const Vec3f& point : cloud.points) {
        low = std::min(low, axis.dot(point));
        high = std::max(high, axis.dot(point));
    }
    // In double, so that rounding doesn't cut the last point off at a fraction of 1.
    const double limit = double{low} + fraction * (double{high} - double{low});
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        if (double{axis.dot(cloud.points[i])} <= limit) indices.push_back(i);
    }
    return indices;
}

CutResult cut_view(const PointCloud& cloud, const PrincipalFrame& frame,
                   const CutSettings& settings) {
    const std::vector<Vec3d> directions = cut_directions(settings.directions);
    const double least = std::max(static_cast<double>(settings.min_points),
                                  settings.min_share * static_cast<double>(cloud.size()));
    const ProximityGraph graph = proximity_graph(cloud.points, settings.cluster_tolerance);
    CutResult result;
    for (std::size_t d = 0; d < directions.size(); ++d) {
        const Vec3d direction = frame.T_cloud_frame.linear() * directions[d];
        for (std::size_t f = 0; f < settings.fractions.size(); ++f) {
            ++result.made;
            std::vector<std::uint32_t> kept =
                largest_group(graph, cut_below(cloud, direction, settings.fractions[f]));
            if (static_cast<double>(kept.size()) < least) {
                ++result.dropped_by_size;
                continue;
            }
            result.subparts.push_back({static_cast<int>(d), static_cast<int>(f), std::move(kept)});
        }
    }
    return result;
}

}  // namespace ostraka
