// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/vertex_rings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/fast_math.hpp"

namespace ostraka {
namespace {

constexpr float kWidestGap = static_cast<float>(0.75 * kPi);
constexpr std::size_t kGrain = 256;  // points that a thread takes at a time

// Whether the directions to the ring leave a wide gap around the normal.
bool at_border(std::span<const Vec3f> points, const Vec3f& normal, std::size_t point,
               std::span<const std::uint32_t> ring) {
    if (ring.size() < 3 || !normal.allFinite()) return true;
    const Vec3d n = normal.cast<double>();
    // Any tangent will do.
    const Vec3d least = std::abs(n.x()) < 0.6 ? Vec3d::UnitX() : Vec3d::UnitY();
    const Vec3d u = n.cross(least).normalized();
    const Vec3d v = n.cross(u);
    std::vector<float> angles;
    for (const std::uint32_t neighbor : ring) {
        const Vec3d offset = (points[neighbor] - points[point]).cast<double>();
        angles.push_back(
            fast_atan2(static_cast<float>(offset.dot(v)), static_cast<float>(offset.dot(u))));
    }
    std::sort(angles.begin(), angles.end());
    float widest = angles.front() - angles.back() + static_cast<float>(2.0 * kPi);
    for (std::size_t i = 1; i < angles.size(); ++i) {
        widest = std::max(widest, angles[i] - angles[i - 1]);
    }
    return widest > kWidestGap;
}

}  // namespace

PointLists vertex_rings(std::span<const Vec3f> points, std::span<const IndexTriangle> triangles) {
    std::vector<std::array<std::uint32_t, 2>> edges;
    edges.reserve(6 * triangles.size());
    for (const IndexTriangle& t : triangles) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t a = t[corner];
            const std::uint32_t b = t[(corner + 1) % 3];
            if (a == b) continue;
            edges.push_back({a, b});
            edges.push_back({b, a});
        }
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    PointLists rings;
    rings.starts.assign(points.size() + 1, 0);
    for (const auto& edge : edges) ++rings.starts[edge[0] + 1];
    for (std::size_t i = 0; i < points.size(); ++i) rings.starts[i + 1] += rings.starts[i];
    for (const auto& edge : edges) rings.items.push_back(edge[1]);
    const auto key = [&](std::uint32_t i) {
        return std::tuple(points[i].x(), points[i].y(), points[i].z());
    };
    const auto before = [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); };
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::sort(rings.items.begin() + rings.starts[i], rings.items.begin() + rings.starts[i + 1],
                  before);
    }
    return rings;
}

PointLists vertex_triangles(std::size_t points, std::span<const IndexTriangle> triangles) {
    PointLists lists;
    lists.starts.assign(points + 1, 0);
    for (const IndexTriangle& triangle : triangles) {
        for (const std::uint32_t corner : triangle) ++lists.starts[corner + 1];
    }
    for (std::size_t i = 0; i < points; ++i) lists.starts[i + 1] += lists.starts[i];
    lists.items.resize(lists.starts[points]);
    std::vector<std::uint32_t> next(lists.starts.begin(), lists.starts.end() - 1);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        for (const std::uint32_t corner : triangles[t]) lists.items[next[corner]++] = t;
    }
    return lists;
}

std::vector<int> border_distances(std::span<const Vec3f> points, std::span<const Vec3f> normals,
                                  const PointLists& rings, int most) {
    std::vector<int> distance(points.size(), most);
    parallel_for(
        points.size(),
        [&](std::size_t i) {
            if (at_border(points, normals[i], i, rings.of(i))) distance[i] = 0;
        },
        kGrain);
    std::vector<std::uint32_t> front;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (distance[i] == 0) front.push_back(i);
    }
    for (int step = 1; step < most && !front.empty(); ++step) {
        std::vector<std::uint32_t> next;
        for (const std::uint32_t i : front) {
            for (const std::uint32_t neighbor : rings.of(i)) {
                if (distance[neighbor] <= step) continue;
                distance[neighbor] = step;
                next.push_back(neighbor);
            }
        }
        front.swap(next);
    }
    return distance;
}

void require_triangles(std::span<const IndexTriangle> triangles, std::size_t points,
                       const char* descriptor) {
    for (const IndexTriangle& t : triangles) {
        if (t[0] < points && t[1] < points && t[2] < points) continue;
        throw InvalidInput(fmt::format("{}: triangle {} {} {} of a cloud of {} points", descriptor,
                                       t[0], t[1], t[2], points));
    }
}

}  // namespace ostraka
