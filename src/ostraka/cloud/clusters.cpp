// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/clusters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/cell_grid.hpp"
#include "ostraka/cloud/kdtree.hpp"

namespace ostraka {
namespace {

class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0U);
    }
    std::uint32_t find(std::uint32_t item) {
        while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
        return item;
    }
    // The smaller root wins, so the result doesn't depend on the order of unions.
    void unite(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<std::uint32_t> parent_;
};

Clusters collect(DisjointSets& sets, std::size_t count, std::size_t min_size) {
    std::vector<std::vector<std::uint32_t>> by_root(count);
    for (std::uint32_t i = 0; i < count; ++i) by_root[sets.find(i)].push_back(i);
    Clusters clusters;
    for (auto& group : by_root) {
        if (!group.empty() && group.size() >= min_size) clusters.push_back(std::move(group));
    }
    std::stable_sort(clusters.begin(), clusters.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    return clusters;
}

// Calls visit(i, j) once for each pair of points closer than the tolerance that isn't united yet.
template <class Visit>
void for_each_close_pair(std::span<const Vec3f> points, double tolerance, const Visit& visit) {
    const CellGrid grid(points, tolerance);
    const auto limit = static_cast<float>(tolerance * tolerance);
    std::vector<std::uint32_t> cells;
    for (std::uint32_t c = 0; c < grid.cell_count(); ++c) {
        grid.neighborhood(c, cells);
        for (const std::uint32_t other : cells) {
            if (other < c) continue;
            for (const std::uint32_t i : grid.members(c)) {
                for (const std::uint32_t j : grid.members(other)) {
                    if (other == c && j <= i) continue;
                    if ((points[i] - points[j]).squaredNorm() < limit) visit(i, j);
                }
            }
        }
    }
}

// Mean squared sine between each normal and those around it: 0 on a plane, large on a crease.
std::vector<float> normal_variation(const PointCloud& cloud, double tolerance) {
    std::vector<float> sum(cloud.size(), 0.0F);
    std::vector<float> count(cloud.size(), 0.0F);
    for_each_close_pair(cloud.points, tolerance, [&](std::uint32_t i, std::uint32_t j) {
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
    DisjointSets sets(points.size());
    for_each_close_pair(points, tolerance,
                        [&](std::uint32_t i, std::uint32_t j) { sets.unite(i, j); });
    return collect(sets, points.size(), min_size);
}

ProximityGraph proximity_graph(std::span<const Vec3f> points, double tolerance) {
    ProximityGraph graph;
    graph.starts.assign(points.size() + 1, 0);
    for_each_close_pair(points, tolerance, [&](std::uint32_t i, std::uint32_t j) {
        ++graph.starts[i + 1];
        ++graph.starts[j + 1];
    });
    std::partial_sum(graph.starts.begin(), graph.starts.end(), graph.starts.begin());
    graph.neighbors.resize(graph.starts.back());
    std::vector<std::uint32_t> next(graph.starts.begin(), graph.starts.end() - 1);
    for_each_close_pair(points, tolerance, [&](std::uint32_t i, std::uint32_t j) {
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
    const std::vector<float> variation = normal_variation(cloud, settings.tolerance);
    const auto crease = [&](std::uint32_t i) { return variation[i] > settings.max_curvature; };
    const auto min_cosine = static_cast<float>(std::cos(settings.max_angle));
    DisjointSets sets(cloud.size());
    for_each_close_pair(cloud.points, settings.tolerance, [&](std::uint32_t i, std::uint32_t j) {
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
    return collect(sets, cloud.size(), settings.min_size);
}

}  // namespace ostraka
