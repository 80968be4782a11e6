// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/clusters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/disjoint_sets.hpp"
#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/point_columns.hpp"

namespace ostraka {
namespace {

// The groups of at least `min_size` points. @param root_of  of point i: equal within a group, below
// `count`.
template <class RootOf>
Clusters collect(std::size_t count, std::size_t min_size, const RootOf& root_of) {
    std::vector<std::uint32_t> roots(count);
    std::vector<std::uint32_t> sizes(count, 0);
    for (std::uint32_t i = 0; i < count; ++i) ++sizes[roots[i] = root_of(i)];
    std::vector<std::uint32_t> cluster_of(count, kNoIndex);  // of a root
    Clusters clusters;
    for (const std::uint32_t root : roots) {  // in the order of the groups' smallest indices
        if (cluster_of[root] != kNoIndex || sizes[root] < min_size) continue;
        cluster_of[root] = static_cast<std::uint32_t>(clusters.size());
        clusters.emplace_back().reserve(sizes[root]);
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t cluster = cluster_of[roots[i]];
        if (cluster != kNoIndex) clusters[cluster].push_back(i);
    }
    std::stable_sort(clusters.begin(), clusters.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    return clusters;
}

// Calls visit(s, t) once for each pair of slots whose points are closer than a tolerance.
class ClosePairs {
  public:
    ClosePairs(std::span<const Vec3f> points, double tolerance)
        : columns_(points, kWiden * tolerance),
          limit_(static_cast<float>(tolerance * tolerance)),
          reach_(static_cast<float>(kWiden * tolerance)) {}

    const PointColumns& columns() const { return columns_; }

    // Each column with itself and with the four after it that touch it: all others are farther
    // than the tolerance, or have had their turn.
    template <class Visit>
    void for_each(const Visit& visit) const {
        const auto [rows, width] = columns_.columns_across();
        for (std::size_t u = 0; u < rows; ++u) {
            for (std::size_t v = 0; v < width; ++v) {
                const SlotRun run = columns_.column(u * width + v);
                if (run.begin == run.end) continue;
                inside(run, visit);
                if (v + 1 < width) between(run, columns_.column(u * width + v + 1), visit);
                if (u + 1 == rows) continue;
                const std::size_t last = std::min(v + 1, width - 1);
                for (std::size_t w = v > 0 ? v - 1 : 0; w <= last; ++w) {
                    between(run, columns_.column((u + 1) * width + w), visit);
                }
            }
        }
    }

  private:
    static constexpr double kWiden = 1.0001;  // beyond rounding

    bool close(std::uint32_t s, std::uint32_t t) const {
        const float dx = columns_.coordinate(0)[s] - columns_.coordinate(0)[t];
        const float dy = columns_.coordinate(1)[s] - columns_.coordinate(1)[t];
        const float dz = columns_.coordinate(2)[s] - columns_.coordinate(2)[t];
        return dx * dx + (dy * dy + dz * dz) < limit_;
    }

    template <class Visit>
    void inside(const SlotRun& run, const Visit& visit) const {
        const float* height = columns_.coordinate(columns_.height_axis());
        for (std::uint32_t s = run.begin; s < run.end; ++s) {
            for (std::uint32_t t = s + 1; t < run.end && height[t] - height[s] < reach_; ++t) {
                if (close(s, t)) visit(s, t);
            }
        }
    }

    // Both runs ascend, so the window of heights in the second only moves up.
    template <class Visit>
    void between(const SlotRun& run, const SlotRun& other, const Visit& visit) const {
        const float* height = columns_.coordinate(columns_.height_axis());
        std::uint32_t first = other.begin;
        for (std::uint32_t s = run.begin; s < run.end; ++s) {
            while (first < other.end && height[s] - height[first] > reach_) ++first;
            for (std::uint32_t t = first; t < other.end && height[t] - height[s] < reach_; ++t) {
                if (close(s, t)) visit(s, t);
            }
        }
    }

    PointColumns columns_;
    float limit_;  // squared
    float reach_;
};

// The same with indices of points.
template <class Visit>
void for_each_close_pair(const ClosePairs& pairs, const Visit& visit) {
    const std::span<const std::uint32_t> order = pairs.columns().order();
    pairs.for_each([&](std::uint32_t s, std::uint32_t t) { visit(order[s], order[t]); });
}

// Mean squared sine between each normal and those around it: 0 on a plane, large on a crease.
std::vector<float> normal_variation(const PointCloud& cloud, const ClosePairs& pairs) {
    std::vector<float> sum(cloud.size(), 0.0F);
    std::vector<float> count(cloud.size(), 0.0F);
    for_each_close_pair(pairs, [&](std::uint32_t i, std::uint32_t j) {
        const float cosine = cloud.normals[i].dot(cloud.normals[j]);
        const float variation = std::max(0.0F, 1.0F - cosine * cosine);
        sum[i] += variation;
        sum[j] += variation;
        count[i] += 1.0F;
        count[j] += 1.0F;
    });
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(1.0F, count[i]);
    return sum;
}

}  // namespace

Clusters euclidean_clusters(std::span<const Vec3f> points, double tolerance, std::size_t min_size) {
    const ClosePairs pairs(points, tolerance);
    DisjointSets slots(points.size());
    pairs.for_each([&](std::uint32_t s, std::uint32_t t) { slots.unite(s, t); });
    std::vector<std::uint32_t> slot_of(points.size());
    for (std::uint32_t s = 0; s < points.size(); ++s) slot_of[pairs.columns().order()[s]] = s;
    return collect(points.size(), min_size,
                   [&](std::uint32_t i) { return slots.find(slot_of[i]); });
}

ProximityGraph proximity_graph(std::span<const Vec3f> points, double tolerance) {
    const ClosePairs pairs(points, tolerance);
    ProximityGraph graph;
    graph.starts.assign(points.size() + 1, 0);
    for_each_close_pair(pairs, [&](std::uint32_t i, std::uint32_t j) {
        ++graph.starts[i + 1];
        ++graph.starts[j + 1];
    });
    std::partial_sum(graph.starts.begin(), graph.starts.end(), graph.starts.begin());
    graph.neighbors.resize(graph.starts.back());
    std::vector<std::uint32_t> next(graph.starts.begin(), graph.starts.end() - 1);
    for_each_close_pair(pairs, [&](std::uint32_t i, std::uint32_t j) {
        graph.neighbors[next[i]++] = j;
        graph.neighbors[next[j]++] = i;
    });
    return graph;
}

std::vector<std::uint32_t> largest_group(const ProximityGraph& graph,
                                         std::span<const std::uint32_t> indices) {
    // 0: not asked for or already in a group; 1: waiting.
    std::vector<std::uint8_t> waiting(graph.starts.size() - 1, 0);
    for (const std::uint32_t i : indices) waiting[i] = 1;
    std::vector<std::uint32_t> largest;
    std::vector<std::uint32_t> group;
    std::size_t left = indices.size();
    for (const std::uint32_t seed : indices) {
        if (waiting[seed] == 0) continue;
        if (left <= largest.size()) break;  // no later group can be larger
        waiting[seed] = 0;
        group.assign(1, seed);
        for (std::size_t head = 0; head < group.size(); ++head) {
            const std::uint32_t i = group[head];
            for (std::uint32_t n = graph.starts[i]; n < graph.starts[i + 1]; ++n) {
                const std::uint32_t j = graph.neighbors[n];
                if (waiting[j] == 0) continue;
                waiting[j] = 0;
                group.push_back(j);
            }
        }
        left -= group.size();
        if (group.size() > largest.size()) largest = group;
    }
    // Ascending order by marking, which is faster than sorting.
    for (const std::uint32_t i : largest) waiting[i] = 2;
    std::vector<std::uint32_t> ascending;
    ascending.reserve(largest.size());
    for (const std::uint32_t i : indices) {
        if (waiting[i] == 2) ascending.push_back(i);
    }
    return ascending;
}

Clusters smooth_clusters(const PointCloud& cloud, const SmoothnessSettings& settings) {
    if (cloud.normals.size() != cloud.size()) throw InvalidInput("smooth clusters need normals");
    const ClosePairs pairs(cloud.points, settings.tolerance);
    const std::vector<float> variation = normal_variation(cloud, pairs);
    const auto crease = [&](std::uint32_t i) { return variation[i] > settings.max_curvature; };
    const auto min_cosine = static_cast<float>(std::cos(settings.max_angle));
    DisjointSets sets(cloud.size());
    for_each_close_pair(pairs, [&](std::uint32_t i, std::uint32_t j) {
        if (crease(i) || crease(j)) return;
        if (cloud.normals[i].dot(cloud.normals[j]) > min_cosine) sets.unite(i, j);
    });
    // Crease points join the group of the nearest smooth point.
    std::vector<std::uint32_t> smooth;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        if (!crease(i)) smooth.push_back(i);
    }
    const PointCloud smooth_cloud = select(cloud, smooth);
    const KdTree tree(smooth_cloud.points);
    std::vector<std::uint32_t> root(cloud.size(), kNoIndex);
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        if (!crease(i)) continue;
        const Neighbor nearest = tree.nearest(cloud.points[i]);
        if (nearest.index == kNoIndex) continue;
        if (nearest.squared_distance < 4.0 * settings.tolerance * settings.tolerance) {
            root[i] = smooth[nearest.index];
        }
    }
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        if (root[i] != kNoIndex) sets.unite(i, root[i]);
    }
    return collect(cloud.size(), settings.min_size, [&](std::uint32_t i) { return sets.find(i); });
}

}  // namespace ostraka
