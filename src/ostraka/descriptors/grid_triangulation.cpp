// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/grid_triangulation.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/descriptors/checks.hpp"

namespace ostraka {
namespace {

float squared_edge(const PointCloud& cloud, std::uint32_t a, std::uint32_t b) {
    return (cloud.points[a] - cloud.points[b]).squaredNorm();  // NaN where an end is a hole
}

// Square of the longest edge allowed: from the median edge along rows and columns.
float edge_limit(const PointCloud& cloud, float longest_edge) {
    const auto width = static_cast<std::uint32_t>(cloud.width);
    std::vector<float> edges;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        const bool has_right = i % width + 1 < width;
        const bool has_below = i + width < cloud.size();
        const float right = has_right ? squared_edge(cloud, i, i + 1) : 0.0F;
        const float below = has_below ? squared_edge(cloud, i, i + width) : 0.0F;
        if (right > 0.0F && std::isfinite(right)) edges.push_back(right);
        if (below > 0.0F && std::isfinite(below)) edges.push_back(below);
    }
    if (edges.empty()) return 0.0F;
    const auto middle = edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 2);
    std::nth_element(edges.begin(), middle, edges.end());
    return *middle * longest_edge * longest_edge;
}

}  // namespace

std::vector<IndexTriangle> triangulate_grid(const PointCloud& cloud,
                                            const TriangulationSettings& settings) {
    const float limit = edge_limit(cloud, settings.longest_edge);
    std::vector<IndexTriangle> triangles;
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const Vec3f& p = cloud.points[a];
        const Vec3f normal = (cloud.points[b] - p).cross(cloud.points[c] - p);
        if (normal.dot(cloud.viewpoint - p) < 0.0F) std::swap(b, c);
        triangles.push_back({a, b, c});
    };
    const auto width = static_cast<std::uint32_t>(cloud.width);
    for (std::uint32_t y = 0; y + 1 < static_cast<std::uint32_t>(cloud.height); ++y) {
        for (std::uint32_t x = 0; x + 1 < width; ++x) {
            const std::uint32_t a = y * width + x;
            const std::uint32_t b = a + 1;
            const std::uint32_t c = a + width;
            const std::uint32_t d = c + 1;
            // Comparisons with a hole's NaN are false, so no triangle touches it.
            const bool ab = squared_edge(cloud, a, b) <= limit;
            const bool ac = squared_edge(cloud, a, c) <= limit;
            const bool bd = squared_edge(cloud, b, d) <= limit;
            const bool cd = squared_edge(cloud, c, d) <= limit;
            const float falling = squared_edge(cloud, a, d);
            const float rising = squared_edge(cloud, b, c);
            const bool whole = ab && ac && bd && cd;
            if (falling <= limit && (!whole || falling <= rising)) {
                if (ab && bd) add(a, b, d);
                if (ac && cd) add(a, d, c);
                if ((ab && bd) || (ac && cd)) continue;
            }
            if (rising <= limit) {
                if (ab && ac) add(a, b, c);
                if (bd && cd) add(b, d, c);
            }
        }
    }
    return triangles;
}

}  // namespace ostraka
