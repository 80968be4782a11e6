// SPDX-License-Identifier: Apache-2.0
#include "ostraka/subparts/cuts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/clusters.hpp"

namespace ostraka {
namespace {

// Where the points lie along a direction.
struct Extent {
    std::vector<float> heights;  // of each point
    float low = std::numeric_limits<float>::max();
    float high = std::numeric_limits<float>::lowest();
    // In double, so that rounding doesn't cut the last point off at a fraction of 1.
    double limit(double fraction) const {
        return double{low} + fraction * (double{high} - double{low});
    }
};

Extent extent_along(const PointCloud& cloud, const Vec3d& direction) {
    const Vec3f axis = direction.cast<float>();
    Extent extent;
    extent.heights.reserve(cloud.size());
    for (const Vec3f& point : cloud.points) {
        const float height = axis.dot(point);
        extent.heights.push_back(height);
        extent.low = std::min(extent.low, height);
        extent.high = std::max(extent.high, height);
    }
    return extent;
}

}  // namespace

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
    const Extent extent = extent_along(cloud, direction);
    const double limit = extent.limit(fraction);
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        if (double{extent.heights[i]} <= limit) indices.push_back(i);
    }
    return indices;
}

namespace {

// The fractions in ascending order, as indices: larger cuts hold the smaller ones.
std::vector<std::size_t> ascending(const std::vector<double>& fractions) {
    std::vector<std::size_t> order(fractions.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return fractions[a] < fractions[b]; });
    return order;
}

// For each point the number of the first cut (in ascending order) that keeps it.
std::vector<std::uint8_t> first_cuts(const Extent& extent, const std::vector<double>& fractions,
                                     const std::vector<std::size_t>& order) {
    std::vector<std::uint8_t> first(extent.heights.size(), static_cast<std::uint8_t>(order.size()));
    for (std::size_t l = order.size(); l-- > 0;) {
        const double limit = extent.limit(fractions[order[l]]);
        for (std::size_t i = 0; i < first.size(); ++i) {
            if (double{extent.heights[i]} <= limit) first[i] = static_cast<std::uint8_t>(l);
        }
    }
    return first;
}

}  // namespace

CutResult cut_view(const PointCloud& cloud, const PrincipalFrame& frame,
                   const CutSettings& settings) {
    const std::vector<Vec3d> directions = cut_directions(settings.directions);
    const std::vector<std::size_t> order = ascending(settings.fractions);
    if (order.size() > 200) throw InvalidInput("more than 200 cut fractions");
    const double least = std::max(static_cast<double>(settings.min_points),
                                  settings.min_share * static_cast<double>(cloud.size()));
    const ProximityGraph graph = proximity_graph(cloud.points, settings.cluster_tolerance);
    CutResult result;
    for (std::size_t d = 0; d < directions.size(); ++d) {
        const Vec3d direction = frame.T_cloud_frame.linear() * directions[d];
        const auto first = first_cuts(extent_along(cloud, direction), settings.fractions, order);
        std::vector<std::vector<std::uint32_t>> groups = largest_groups(graph, first, order.size());
        std::vector<std::vector<std::uint32_t>> kept(order.size());
        for (std::size_t l = 0; l < order.size(); ++l) kept[order[l]] = std::move(groups[l]);
        for (std::size_t f = 0; f < kept.size(); ++f) {
            ++result.made;
            if (static_cast<double>(kept[f].size()) < least) {
                ++result.dropped_by_size;
                continue;
            }
            result.subparts.push_back(
                {static_cast<int>(d), static_cast<int>(f), std::move(kept[f])});
        }
    }
    return result;
}

}  // namespace ostraka
