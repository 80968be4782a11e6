// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/normal_orientation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/side_votes.hpp"

namespace ostraka {
namespace {

// Distance of the k-th neighbor, in spacings (1 / sqrt(points per area)): k = pi r^2.
double reach_in_spacings(std::size_t k) {
    return std::sqrt(static_cast<double>(k) / kPi);
}

struct Edge {
    std::uint32_t from;
    std::uint32_t to;
    float agreement;  // of the normals: -1 opposite, 1 the same, 0 can't be told
};

// The dot product of the normals' parts across the line between the points.
float agreement_of(const Vec3f& a, const Vec3f& b, const Vec3f& line) {
    const float length = line.squaredNorm();
    const float along = length > 0.0F ? a.dot(line) * b.dot(line) / length : 0.0F;
    return a.dot(b) - along;
}

struct Graph {
    std::vector<Edge> edges;
    double spacing = 0.0;  // median
};

Graph connect_neighbors(std::span<const Vec3f> points, std::span<const Vec3f> normals,
                        std::size_t count) {
    const KdTree tree(points);
    std::vector<Edge> edges(points.size() * count);
    std::vector<float> reach(points.size(), 0.0F);
    parallel_for(
        points.size(),
        [&](std::size_t i) {
            thread_local std::vector<Neighbor> near;
            const auto self = static_cast<std::uint32_t>(i);
            tree.nearest(points[i], count + 1, near);
            std::size_t used = 0;
            for (const Neighbor& neighbor : near) {
                if (neighbor.index == self || used == count) continue;
                const Vec3f line = points[neighbor.index] - points[i];
                edges[i * count + used++] = {
                    self, neighbor.index, agreement_of(normals[i], normals[neighbor.index], line)};
            }
            for (; used < count; ++used) edges[i * count + used] = {self, self, 0.0F};
            reach[i] = std::sqrt(near.back().squared_distance);
        },
        256);
    const auto middle = reach.begin() + static_cast<std::ptrdiff_t>(reach.size() / 2);
    std::nth_element(reach.begin(), middle, reach.end());
    return {std::move(edges), double{*middle} / reach_in_spacings(count)};
}

// Strongest agreement first; a counting sort, which keeps the order of equals.
std::vector<Edge> by_strength(const std::vector<Edge>& edges) {
    constexpr std::size_t kSteps = 1024;
    const auto step = [](const Edge& edge) {
        const float strength = std::clamp(std::abs(edge.agreement), 0.0F, 1.0F);
        return static_cast<std::size_t>((1.0F - strength) * static_cast<float>(kSteps - 1));
    };
    std::vector<std::size_t> starts(kSteps + 1, 0);
    for (const Edge& edge : edges) ++starts[step(edge) + 1];
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    std::vector<Edge> sorted(edges.size());
    for (const Edge& edge : edges) sorted[starts[step(edge)]++] = edge;
    return sorted;
}

// Disjoint sets that know whether a point's normal is turned against that of its set's root.
class TurnedSets {
  public:
    TurnedSets(std::span<const SideVotes> votes, double decisive)
        : nodes_(votes.size()), groups_(votes.size()), decisive_(decisive) {
        for (std::uint32_t i = 0; i < votes.size(); ++i) {
            nodes_[i] = {i, false};
            groups_[i] = {votes[i].front - votes[i].back, votes[i].front + votes[i].back};
        }
    }

    struct Node {
        std::uint32_t parent;
        bool turned;  // against the parent
    };
    struct Group {
        float margin;  // votes for the root's side less those for the other
        float total;
    };

    /// The root, and whether the item is turned against it.
    Node find(std::uint32_t item) {
        bool turned = false;
        while (nodes_[item].parent != item) {
            Node& node = nodes_[item];
            const Node above = nodes_[node.parent];
            node.turned = node.turned != above.turned;
            node.parent = above.parent;
            turned = turned != node.turned;
            item = node.parent;
        }
        return {item, turned};
    }
    const Group& group(std::uint32_t root) const { return groups_[root]; }
    bool sure(const Group& group) const {
        constexpr float kFewVotes = 40.0F;  // about five points that are seen from their front
        return group.total >= kFewVotes && static_cast<double>(std::abs(group.margin)) >=
                                               decisive_ * static_cast<double>(group.total);
    }
    /// Joins the sets of an edge's ends. @param ask_votes  where both sets are sure of their side,
    /// it is their votes that count and not the edge.
    void join(const Edge& edge, bool ask_votes) {
        const Node from = find(edge.from);
        const Node to = find(edge.to);
        if (from.parent == to.parent) return;
        const std::uint32_t root = std::min(from.parent, to.parent);
        const std::uint32_t other = std::max(from.parent, to.parent);
        Group& kept = groups_[root];
        const Group& added = groups_[other];
        bool turned = (from.turned != to.turned) != (edge.agreement < 0.0F);
        if (ask_votes && sure(kept) && sure(added)) {
            turned = (kept.margin < 0.0F) != (added.margin < 0.0F);
        }
        nodes_[other] = {root, turned};
        const float margin = turned ? -added.margin : added.margin;
        if (!ask_votes || sure(kept) == sure(added)) {
            kept = {kept.margin + margin, kept.total + added.total};
        } else if (sure(added)) {  // what is unsure must not outvote it by its size
            kept = {margin, added.total};
        }
    }

  private:
    std::vector<Node> nodes_;
    std::vector<Group> groups_;
    double decisive_;
};

// One edge between each two sets that touch, whose agreement is the sum of all edges between them:
// a whole crease tells more than the best edge across it.
std::vector<Edge> edges_of_sets(TurnedSets& sets, std::span<const Edge> edges) {
    std::vector<Edge> between;
    for (const Edge& edge : edges) {
        const TurnedSets::Node from = sets.find(edge.from);
        const TurnedSets::Node to = sets.find(edge.to);
        if (from.parent == to.parent) continue;
        between.push_back({std::min(from.parent, to.parent), std::max(from.parent, to.parent),
                           from.turned != to.turned ? -edge.agreement : edge.agreement});
    }
    const auto ends = [](const Edge& edge) { return std::pair(edge.from, edge.to); };
    std::stable_sort(between.begin(), between.end(),
                     [&](const Edge& a, const Edge& b) { return ends(a) < ends(b); });
    std::vector<Edge> sums;
    for (const Edge& edge : between) {
        if (sums.empty() || ends(sums.back()) != ends(edge)) {
            sums.push_back(edge);
        } else {
            sums.back().agreement += edge.agreement;
        }
    }
    std::stable_sort(sums.begin(), sums.end(), [](const Edge& a, const Edge& b) {
        return std::abs(a.agreement) > std::abs(b.agreement);
    });
    return sums;
}

TurnedSets grow_sets(std::span<const Edge> edges, std::span<const SideVotes> votes,
                     const OrientationSettings& settings) {
    TurnedSets sets(votes, settings.decisive);
    std::size_t smooth = 0;
    while (smooth < edges.size() &&
           static_cast<double>(std::abs(edges[smooth].agreement)) >= settings.smooth) {
        sets.join(edges[smooth++], false);
    }
    for (const Edge& edge : edges_of_sets(sets, edges.subspan(smooth))) sets.join(edge, true);
    return sets;
}

// The same sign for every group whose sides are seen alike as most of its normals have.
OrientationResult turn_outward(TurnedSets& sets, std::span<Vec3f> normals) {
    constexpr float kAlike = 0.02F;  // of all votes
    OrientationResult result;
    std::vector<std::int32_t> against(normals.size(), 0);  // root: normals turned less the others
    for (std::uint32_t i = 0; i < normals.size(); ++i) {
        const auto [root, turned] = sets.find(i);
        against[root] += turned ? 1 : -1;
        result.groups += root == i ? 1 : 0;
    }
    for (std::uint32_t i = 0; i < normals.size(); ++i) {
        const auto [root, turned] = sets.find(i);
        const TurnedSets::Group& group = sets.group(root);
        const bool unsure = !(std::abs(group.margin) > kAlike * group.total);
        const bool root_turns = unsure ? against[root] > 0 : group.margin < 0.0F;
        if (unsure) ++result.unsure;
        if (turned == root_turns) continue;
        normals[i] = -normals[i];
        ++result.turned;
    }
    return result;
}

// Those with a point and a direction.
std::vector<std::uint32_t> usable_points(const PointCloud& cloud) {
    std::vector<std::uint32_t> usable;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        if (cloud.points[i].allFinite() && cloud.normals[i].squaredNorm() > 0.5F) {
            usable.push_back(i);
        }
    }
    return usable;
}

void estimate_missing(PointCloud& cloud) {
    if (!cloud.normals.empty()) return;
    std::vector<std::uint32_t> finite;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        if (cloud.points[i].allFinite()) finite.push_back(i);
    }
    const std::vector<Vec3f> normals = estimate_normals(select(cloud, finite));
    cloud.normals.assign(cloud.size(), Vec3f::Constant(std::numeric_limits<float>::quiet_NaN()));
    for (std::size_t i = 0; i < finite.size(); ++i) cloud.normals[finite[i]] = normals[i];
}

void check_settings(const OrientationSettings& settings) {
    if (settings.neighbors < 1) throw InvalidInput("orientation: neighbors must be at least 1");
    if (!(settings.smooth > 0.0) || !(settings.decisive >= 0.0)) {
        throw InvalidInput("orientation: smooth must be positive and decisive not negative");
    }
}

}  // namespace

OrientationResult orient_normals(PointCloud& cloud, const OrientationSettings& settings) {
    check(cloud);
    check_settings(settings);
    estimate_missing(cloud);
    const std::vector<std::uint32_t> usable = usable_points(cloud);
    if (usable.empty()) return {};
    PointCloud part = select(cloud, usable);
    const Graph graph =
        connect_neighbors(part.points, part.normals, static_cast<std::size_t>(settings.neighbors));
    if (!(graph.spacing > 0.0)) return {.groups = 0, .unsure = usable.size(), .turned = 0};
    const std::vector<SideVotes> votes = vote_for_sides(part.points, part.normals, graph.spacing);
    TurnedSets sets = grow_sets(by_strength(graph.edges), votes, settings);
    const OrientationResult result = turn_outward(sets, part.normals);
    for (std::size_t i = 0; i < usable.size(); ++i) cloud.normals[usable[i]] = part.normals[i];
    return result;
}

}  // namespace ostraka
