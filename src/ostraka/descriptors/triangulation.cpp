// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/cell_grid.hpp"
#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/delaunay_star.hpp"
#include "ostraka/descriptors/grid_triangulation.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kChunk = 32;  // cells that share scratch memory

// A radius that holds about two dozen neighbors: from the eighth nearest neighbor of some points.
float search_radius(std::span<const Vec3f> points) {
    constexpr std::size_t kSamples = 24;
    constexpr std::size_t kNth = 8;
    std::vector<float> eighth;
    const std::size_t step = std::max<std::size_t>(1, points.size() / kSamples);
    for (std::size_t i = 0; i < points.size(); i += step) {
        std::array<float, kNth> nearest;
        nearest.fill(std::numeric_limits<float>::max());
        for (const Vec3f& other : points) {
            const float x = other.x() - points[i].x();
            const float y = other.y() - points[i].y();
            const float z = other.z() - points[i].z();
            const float squared = x * x + y * y + z * z;
            if (squared >= nearest.back() || squared == 0.0F) continue;
            std::size_t slot = kNth - 1;
            for (; slot > 0 && nearest[slot - 1] > squared; --slot)
                nearest[slot] = nearest[slot - 1];
            nearest[slot] = squared;
        }
        // With few points the farthest of all stands in.
        const auto found =
            std::find(nearest.begin(), nearest.end(), std::numeric_limits<float>::max());
        if (found != nearest.begin()) eighth.push_back(*(found - 1));
    }
    if (eighth.empty()) return 0.0F;
    std::nth_element(eighth.begin(),
                     eighth.begin() + static_cast<std::ptrdiff_t>(eighth.size() / 2), eighth.end());
    return 1.6F * std::sqrt(eighth[eighth.size() / 2]);
}

std::vector<Star> build_stars(const PointCloud& cloud, float radius, const CellGrid& grid) {
    std::vector<Star> stars(cloud.size());
    std::vector<float> weights(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) weights[i] = star_weight(cloud.points[i]);
    const std::size_t chunks = (grid.cell_count() + kChunk - 1) / kChunk;
    parallel_for(chunks, [&](std::size_t chunk) {
        std::vector<std::uint32_t> cells;
        Nearby nearby;
        StarScratch scratch;
        const std::size_t end = std::min(grid.cell_count(), (chunk + 1) * kChunk);
        for (std::size_t c = chunk * kChunk; c < end; ++c) {
            grid.neighborhood(c, cells);
            nearby.clear();
            for (const std::uint32_t cell : cells) {
                for (const std::uint32_t i : grid.members(cell)) {
                    nearby.add(cloud.points[i], cloud.normals[i], weights[i], i);
                }
            }
            for (const std::uint32_t p : grid.members(c)) {
                stars[p] =
                    delaunay_star(cloud.points[p], cloud.normals[p], radius, nearby, scratch);
            }
        }
    });
    return stars;
}

// Square of the longest edge allowed.
float edge_limit(std::span<const Star> stars, float radius, float longest_edge) {
    double sum = 0.0;
    std::size_t count = 0;
    for (const Star& star : stars) {
        if (!(star.nearest > 0.0F)) continue;
        sum += double{star.nearest} * radius;
        ++count;
    }
    const double limit = count > 0 ? sum / static_cast<double>(count) * longest_edge : 0.0;
    return static_cast<float>(limit * limit);
}

std::vector<IndexTriangle> agreed_triangles(const PointCloud& cloud, std::span<const Star> stars,
                                            float limit) {
    const auto short_edge = [&](std::uint32_t a, std::uint32_t b) {
        return (cloud.points[a] - cloud.points[b]).squaredNorm() <= limit;
    };
    std::vector<IndexTriangle> triangles;
    triangles.reserve(2 * stars.size());
    for (std::uint32_t p = 0; p < stars.size(); ++p) {
        const Star& star = stars[p];
        const std::size_t last =
            star.closed ? star.count : std::max<std::size_t>(star.count, 1) - 1;
        for (std::size_t i = 0; i < last; ++i) {
            const std::uint32_t a = star.neighbors[i];
            const std::uint32_t b = star.neighbors[i + 1 < star.count ? i + 1 : 0];
            const bool at_a = stars[a].holds(b, p);
            const bool at_b = stars[b].holds(p, a);
            // The lowest of the points that hold the triangle reports it.
            if ((at_a && a < p) || (at_b && b < p) || (!at_a && !at_b)) continue;
            if (short_edge(p, a) && short_edge(a, b) && short_edge(b, p)) {
                triangles.push_back({p, a, b});
            }
        }
    }
    return triangles;
}

std::vector<IndexTriangle> triangulate_stars(const PointCloud& cloud,
                                             const TriangulationSettings& settings) {
    require_normals(cloud, "triangulation");
    const float radius = search_radius(cloud.points);
    if (!(radius > 0.0F) || cloud.size() < 3) return {};
    // Outliers must not blow up the grid: cells grow with the extent, stars keep their radius.
    Vec3f low = cloud.points.front();
    Vec3f high = low;
    for (const Vec3f& point : cloud.points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    const double extent = (high - low).cast<double>().maxCoeff();
    const CellGrid grid(cloud.points, std::max(double{radius}, extent / 500'000.0));
    const std::vector<Star> stars = build_stars(cloud, radius, grid);
    return agreed_triangles(cloud, stars, edge_limit(stars, radius, settings.longest_edge));
}

}  // namespace

std::vector<IndexTriangle> triangulate(const PointCloud& cloud,
                                       const TriangulationSettings& settings) {
    check(cloud);
    if (cloud.empty()) return {};
    if (!(settings.longest_edge > 0.0F)) {
        throw InvalidInput(fmt::format("triangulation: longest edge {:g}, must be positive",
                                       settings.longest_edge));
    }
    if (cloud.organized()) return triangulate_grid(cloud, settings);
    require_points(cloud, "triangulation");
    return triangulate_stars(cloud, settings);
}

}  // namespace ostraka
