// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/cell_order.hpp"
#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/delaunay_star.hpp"
#include "ostraka/descriptors/grid_triangulation.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kChunk = 32;  // cells that share scratch memory

constexpr std::size_t kNth = 8;
using Nearest = std::array<float, kNth>;  // squared distances, ascending

// Puts the squared distances of the points from the center, where they are positive, among the
// nearest.
OSTRAKA_VECTOR_CLONES
void keep_nearest(const float* xyz, std::size_t count, const Vec3f& center, Nearest& nearest) {
    constexpr std::size_t kBlock = 256;
    const float cx = center.x();
    const float cy = center.y();
    const float cz = center.z();
    float distances[kBlock];
    for (std::size_t first = 0; first < count; first += kBlock) {
        const std::size_t end = count - first < kBlock ? count - first : kBlock;
        const float* block = xyz + 3 * first;
        for (std::size_t i = 0; i < end; ++i) {
            const float x = block[3 * i] - cx;
            const float y = block[3 * i + 1] - cy;
            const float z = block[3 * i + 2] - cz;
            const float squared = x * x + y * y + z * z;
            distances[i] = squared > 0.0F ? squared : std::numeric_limits<float>::max();
        }
        for (std::size_t i = 0; i < end; ++i) {
            if (distances[i] >= nearest.back()) continue;
            std::size_t slot = kNth - 1;
            for (; slot > 0 && nearest[slot - 1] > distances[i]; --slot) {
                nearest[slot] = nearest[slot - 1];
            }
            nearest[slot] = distances[i];
        }
    }
}

// A radius that holds about two dozen neighbors: from the eighth nearest neighbor of some points.
float search_radius(std::span<const Vec3f> points) {
    constexpr std::size_t kSamples = 24;
    std::vector<float> eighth;
    const std::size_t step = std::max<std::size_t>(1, points.size() / kSamples);
    for (std::size_t i = 0; i < points.size(); i += step) {
        Nearest nearest;
        nearest.fill(std::numeric_limits<float>::max());
        keep_nearest(points.front().data(), points.size(), points[i], nearest);
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

// The points in the order of cells: stars and triangles are found in this order, so that what lies
// together is stored together. Larger cells: fewer copies of what lies around them, more of it to
// look at for each point.
struct SortedPoints {
    CellOrder order;
    std::vector<std::uint32_t> cells;  // where the occupied cells start in the order; and its end
    StarPoints points;

    SortedPoints(const PointCloud& cloud, float radius) : order(cloud.points, 1.5F * radius) {
        for (std::size_t c = 0; c < order.cell_count(); ++c) {
            if (order.begin(c) < order.begin(c + 1)) cells.push_back(order.begin(c));
        }
        cells.push_back(static_cast<std::uint32_t>(cloud.size()));
        points.resize(cloud.size());
        for (std::uint32_t i = 0; i < cloud.size(); ++i) {
            const std::uint32_t index = order.order()[i];
            points.set(i, cloud.points[index], cloud.normals[index], i);
        }
    }
};

struct CellScratch {
    std::vector<std::uint32_t> list;
    StarPoints nearby;
    StarScratch star;
};

// The stars of the points [first, end) of one cell.
void build_stars_of_cell(const SortedPoints& sorted, float radius, std::size_t first,
                         std::size_t end, CellScratch& scratch, std::vector<Star>& stars) {
    Vec3f low = sorted.points.position(first);
    Vec3f high = low;
    for (std::size_t i = first; i < end; ++i) {
        low = low.cwiseMin(sorted.points.position(i));
        high = high.cwiseMax(sorted.points.position(i));
    }
    const Vec3f reach = Vec3f::Constant(1.000001F * radius);
    scratch.nearby.resize(0);
    sorted.order.for_runs(low - reach, high + reach, [&](std::size_t from, std::size_t to) {
        append_near_box(sorted.points, from, to, low, high, radius, scratch.list, scratch.nearby);
    });
    for (std::size_t i = first; i < end; ++i) {
        stars[i] = delaunay_star(scratch.nearby, sorted.points.position(i), sorted.points.normal(i),
                                 radius, scratch.star);
    }
}

std::vector<Star> build_stars(const SortedPoints& sorted, float radius) {
    std::vector<Star> stars(sorted.points.count);
    const std::size_t cells = sorted.cells.size() - 1;
    const std::size_t chunks = (cells + kChunk - 1) / kChunk;
    parallel_for(chunks, [&](std::size_t chunk) {
        CellScratch scratch;
        const std::size_t end = std::min(cells, (chunk + 1) * kChunk);
        for (std::size_t c = chunk * kChunk; c < end; ++c) {
            build_stars_of_cell(sorted, radius, sorted.cells[c], sorted.cells[c + 1], scratch,
                                stars);
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

// Appends the triangles of point p that the star of another corner holds, too, if no lower point
// reports them. @return how many. @param found  room for Star::kLargest.
OSTRAKA_VECTOR_CLONES
std::size_t agreed_triangles(std::span<const Star> stars, std::uint32_t p, IndexTriangle* found) {
    const Star& star = stars[p];
    std::size_t count = 0;
    for (std::size_t i = 0; i < star.triangles; ++i) {
        const std::uint32_t a = star.neighbors[i];
        const std::uint32_t b = star.neighbors[i + 1];
        const bool at_a = holds(stars[a], b, p);
        const bool at_b = holds(stars[b], p, a);
        // The lowest of the points that hold the triangle reports it.
        const bool mine = (at_a | at_b) & !(at_a & (a < p)) & !(at_b & (b < p));
        found[count] = {p, a, b};
        count += mine ? 1U : 0U;
    }
    // Rounding may lead gift wrapping twice around.
    std::sort(found, found + count);
    return static_cast<std::size_t>(std::unique(found, found + count) - found);
}

std::vector<IndexTriangle> short_triangles(const SortedPoints& sorted, std::span<const Star> stars,
                                           float limit) {
    const auto short_edge = [&](std::uint32_t a, std::uint32_t b) {
        return (sorted.points.position(a) - sorted.points.position(b)).squaredNorm() <= limit;
    };
    const std::span<const std::uint32_t> index = sorted.order.order();
    std::vector<IndexTriangle> triangles;
    triangles.reserve(2 * stars.size());
    std::array<IndexTriangle, Star::kLargest + 1> agreed;
    for (std::uint32_t p = 0; p < stars.size(); ++p) {
        const std::size_t count = agreed_triangles(stars, p, agreed.data());
        for (std::size_t i = 0; i < count; ++i) {
            const auto& [a, b, c] = agreed[i];
            if (short_edge(a, b) && short_edge(b, c) && short_edge(c, a)) {
                triangles.push_back({index[a], index[b], index[c]});
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
    const SortedPoints sorted(cloud, radius);
    const std::vector<Star> stars = build_stars(sorted, radius);
    return short_triangles(sorted, stars, edge_limit(stars, radius, settings.longest_edge));
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
