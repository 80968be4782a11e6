// SPDX-License-Identifier: Apache-2.0
// Garland & Heckbert 1997, with departures:
// - Quadrics are weighted by area and divided by the total, so that the cost is a mean square
//   distance; a little of the squared edge length is added, which orders the collapses in planes.
// - The vertex is drawn toward the edge's middle where the quadric leaves it open.
// - Each collapse checks a true bound: the input vertices near it, carried along by the triangles,
//   must stay within max_error of the new triangles.
// - The link condition keeps the mesh manifold (Dey, Edelsbrunner, Guha, Nekhayev 1999).
#include "ostraka/mesh/simplify.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <string>

#include "ostraka/base/error.hpp"
#include "ostraka/mesh/simplify_geometry.hpp"

namespace ostraka {
namespace {

constexpr double kCenterPull = 1e-5;    // weight of the edge's middle against unit-weight planes
constexpr double kLengthWeight = 1e-7;  // of squared edge length, for the order only
constexpr double kLeastCosine = 0.2;    // between a triangle's normals before and after
constexpr double kLeastAspect = 1e-3;   // height of a triangle against its longest side
constexpr double kCloseEnough = 1e-3;   // of max_error: no nearer triangle is looked for

class Simplifier {
  public:
    Simplifier(const TriangleMesh& mesh, const SimplifySettings& settings);
    TriangleMesh run();

  private:
    struct Target {
        Vec3d position;
        double mean_square;  // distance to the planes
    };

    void check_closed() const;
    void check_fans() const;
    std::vector<std::uint32_t> neighbors(std::uint32_t v) const;
    Target target(std::uint32_t u, std::uint32_t v) const;
    void push(std::uint32_t u, std::uint32_t v);
    bool link_condition(std::uint32_t u, std::uint32_t v) const;
    bool keeps_orientation(std::uint32_t v, std::uint32_t other, const Vec3d& position) const;
    bool try_collapse(std::uint32_t u, std::uint32_t v, const Vec3d& position);
    bool folds_back(const Vec3d& position, std::uint32_t u, std::uint32_t v) const;
    std::uint32_t across(std::uint32_t t, std::uint32_t a, std::uint32_t b) const;
    void mark_folded(std::uint32_t t);
    bool assign_points(const Vec3d& position, std::uint32_t u, std::uint32_t v);
    void collapse(std::uint32_t u, std::uint32_t v, const Vec3d& position);
    bool has(std::uint32_t t, std::uint32_t v) const {
        const Triangle& corners = triangles_[t];
        return corners[0] == v || corners[1] == v || corners[2] == v;
    }
    Vec3d normal_with(std::uint32_t t, std::uint32_t v, const Vec3d& position) const;

    SimplifySettings settings_;
    std::vector<Vec3d> input_;      // vertices as given
    std::vector<Vec3d> positions_;  // now
    std::vector<Quadric> quadrics_;
    std::vector<std::uint32_t> stamps_;  // changes of each vertex; kNoIndex if it is gone
    std::vector<Triangle> triangles_;
    std::vector<char> gone_;                           // of each triangle
    std::vector<char> folded_;                         // of each triangle: turns back on a neighbor
    std::vector<std::vector<std::uint32_t>> fans_;     // of each vertex: its triangles
    std::vector<std::vector<std::uint32_t>> carried_;  // of each triangle: input vertices
    std::size_t left_ = 0;
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
    // Scratch of one collapse.
    std::vector<std::uint32_t> ring_;  // triangles that stay, with u or v
    std::vector<std::pair<std::uint32_t, std::uint32_t>> homes_;  // input vertex -> triangle
};

Simplifier::Simplifier(const TriangleMesh& mesh, const SimplifySettings& settings)
    : settings_(settings), triangles_(mesh.triangles), left_(mesh.triangles.size()) {
    for (const Vec3f& vertex : mesh.vertices) input_.push_back(vertex.cast<double>());
    positions_ = input_;
    quadrics_.resize(input_.size());
    stamps_.resize(input_.size(), 0);
    gone_.resize(triangles_.size(), 0);
    fans_.resize(input_.size());
    carried_.resize(triangles_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
        for (const std::uint32_t v : triangles_[t]) {
            if (v >= input_.size()) throw InvalidInput("simplify: a vertex index is out of range");
            fans_[v].push_back(t);
        }
        const Vec3d area = area_vector(mesh, triangles_[t]);
        const double size = area.norm();
        if (!std::isfinite(size)) throw InvalidInput("simplify: a vertex is not finite");
        if (size == 0.0) continue;
        const Vec3d n = area / size;
        for (const std::uint32_t v : triangles_[t]) {
            quadrics_[v].add_plane(n, -n.dot(positions_[triangles_[t][0]]), size);
        }
    }
    check_closed();
    folded_.resize(triangles_.size(), 0);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) mark_folded(t);
}

void Simplifier::check_closed() const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const Triangle& t : triangles_) {
        for (int k = 0; k < 3; ++k) edges.emplace_back(t[k], t[(k + 1) % 3]);
    }
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto& [a, b] = edges[i];
        const bool twice = i + 1 < edges.size() && edges[i] == edges[i + 1];
        const bool paired = std::binary_search(edges.begin(), edges.end(), std::pair(b, a));
        if (twice || !paired || a == b) {
            throw InvalidInput("simplify: the edge from vertex " + std::to_string(a) + " to " +
                               std::to_string(b) + " is open or not manifold");
        }
    }
    check_fans();
}

void Simplifier::check_fans() const {
    // One fan: as many triangles around a vertex as one can reach by stepping over edges.
    for (std::uint32_t v = 0; v < fans_.size(); ++v) {
        if (fans_[v].empty()) continue;
        const auto next = [&](std::uint32_t from) {
            for (const std::uint32_t t : fans_[v]) {
                for (int k = 0; k < 3; ++k) {
                    if (triangles_[t][k] == v && triangles_[t][(k + 1) % 3] == from) {
                        return triangles_[t][(k + 2) % 3];
                    }
                }
            }
            return kNoIndex;
        };
        const Triangle& t = triangles_[fans_[v][0]];
        const std::uint32_t start = t[0] == v ? t[1] : t[1] == v ? t[2] : t[0];
        std::size_t steps = 1;
        for (std::uint32_t w = next(start); w != start; w = next(w)) ++steps;
        if (steps != fans_[v].size()) {
            throw InvalidInput("simplify: vertex " + std::to_string(v) + " joins two fans");
        }
    }
}

std::vector<std::uint32_t> Simplifier::neighbors(std::uint32_t v) const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t t : fans_[v]) {
        for (const std::uint32_t w : triangles_[t]) {
            if (w != v) found.push_back(w);
        }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

Simplifier::Target Simplifier::target(std::uint32_t u, std::uint32_t v) const {
    // Relative to the middle, so that rounding doesn't depend on the place of the origin.
    Quadric q = quadrics_[u];
    q += quadrics_[v];
    const Vec3d middle = 0.5 * (positions_[u] + positions_[v]);
    if (!(q.weight > 0.0)) return {middle, 0.0};
    const double pull = kCenterPull * q.weight;
    const Vec3d slope = q.a * middle + q.b;
    const Eigen::Matrix3d stiff = q.a + pull * Mat3d::Identity();
    const Vec3d position = middle - Vec3d(stiff.inverse() * Eigen::Vector3d(slope));
    return {position, std::max(q.at(position), 0.0) / q.weight};
}

void Simplifier::push(std::uint32_t u, std::uint32_t v) {
    const Target best = target(u, v);
    if (best.mean_square > settings_.max_error * settings_.max_error) return;
    const double length = (positions_[u] - positions_[v]).squaredNorm();
    queue_.push({best.mean_square + kLengthWeight * length, std::min(u, v), std::max(u, v),
                 stamps_[std::min(u, v)], stamps_[std::max(u, v)]});
}

bool Simplifier::link_condition(std::uint32_t u, std::uint32_t v) const {
    const auto around_u = neighbors(u);
    const auto around_v = neighbors(v);
    std::vector<std::uint32_t> both;
    std::set_intersection(around_u.begin(), around_u.end(), around_v.begin(), around_v.end(),
                          std::back_inserter(both));
    // With 3 neighbors each, u and v belong to a tetrahedron, which has nothing to give.
    return both.size() == 2 && around_u.size() + around_v.size() > 6;
}

Vec3d Simplifier::normal_with(std::uint32_t t, std::uint32_t v, const Vec3d& position) const {
    std::array<Vec3d, 3> p;
    for (int k = 0; k < 3; ++k) {
        p[k] = triangles_[t][k] == v ? position : positions_[triangles_[t][k]];
    }
    return (p[1] - p[0]).cross(p[2] - p[0]);
}

// Whether the triangles of v without `other` neither flip nor turn into slivers.
bool Simplifier::keeps_orientation(std::uint32_t v, std::uint32_t other,
                                   const Vec3d& position) const {
    for (const std::uint32_t t : fans_[v]) {
        if (has(t, other)) continue;
        const Vec3d before = normal_with(t, v, positions_[v]);
        const Vec3d after = normal_with(t, v, position);
        const double cosine_scale = before.norm() * after.norm();
        // A triangle that is folded over already may turn.
        if (folded_[t] == 0 && cosine_scale > 0.0 &&
            before.dot(after) < kLeastCosine * cosine_scale) {
            return false;
        }
        double before_longest = 0.0;
        double after_longest = 0.0;
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = triangles_[t][k];
            const std::uint32_t b = triangles_[t][(k + 1) % 3];
            const Vec3d& pa = a == v ? position : positions_[a];
            const Vec3d& pb = b == v ? position : positions_[b];
            before_longest =
                std::max(before_longest, (positions_[a] - positions_[b]).squaredNorm());
            after_longest = std::max(after_longest, (pa - pb).squaredNorm());
        }
        const double aspect = after.norm() / std::max(after_longest, 1e-300);
        const double old_aspect = before.norm() / std::max(before_longest, 1e-300);
        if (aspect < kLeastAspect && aspect < old_aspect) return false;
    }
    return true;
}

// The other triangle at an edge of t.
std::uint32_t Simplifier::across(std::uint32_t t, std::uint32_t a, std::uint32_t b) const {
    for (const std::uint32_t other : fans_[a]) {
        if (other != t && has(other, b)) return other;
    }
    return kNoIndex;
}

void Simplifier::mark_folded(std::uint32_t t) {
    const Vec3d normal = normal_with(t, kNoIndex, {});
    folded_[t] = 0;
    for (int k = 0; k < 3; ++k) {
        const std::uint32_t other = across(t, triangles_[t][k], triangles_[t][(k + 1) % 3]);
        if (turns_back(normal, normal_with(other, kNoIndex, {}))) folded_[t] = 1;
    }
}

// Whether the collapse would turn the surface back on itself at more edges than now.
bool Simplifier::folds_back(const Vec3d& position, std::uint32_t u, std::uint32_t v) const {
    const auto moves = [&](std::uint32_t w) { return w == u || w == v; };
    std::vector<Vec3d> normals;
    int allowed = 0;
    for (const std::uint32_t t : ring_) {
        normals.push_back(normal_with(t, has(t, u) ? u : v, position));
        allowed += folded_[t];
    }
    int folds = 0;
    for (std::size_t i = 0; i < ring_.size(); ++i) {
        const Triangle& corners = triangles_[ring_[i]];
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = corners[k];
            const std::uint32_t b = corners[(k + 1) % 3];
            if (!moves(a) && !moves(b)) {
                const Vec3d other = normal_with(across(ring_[i], a, b), kNoIndex, {});
                folds += turns_back(normals[i], other) ? 1 : 0;
            }
            if (moves(a)) continue;
            for (std::size_t j = i + 1; j < ring_.size(); ++j) {
                if (has(ring_[j], a)) folds += turns_back(normals[i], normals[j]) ? 1 : 0;
            }
        }
    }
    return 2 * folds > allowed;
}

// Finds the new triangle of every input vertex near the edge; false if one is too far from all.
bool Simplifier::assign_points(const Vec3d& position, std::uint32_t u, std::uint32_t v) {
    std::vector<std::array<Vec3d, 3>> shapes;
    for (const std::uint32_t t : ring_) {
        auto& shape = shapes.emplace_back();
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t w = triangles_[t][k];
            shape[k] = w == u || w == v ? position : positions_[w];
        }
    }
    const double bound = settings_.max_error * settings_.max_error;
    const double enough = bound * kCloseEnough * kCloseEnough;
    homes_.clear();
    std::size_t last = 0;  // successive points are often near the same triangle
    const auto place = [&](std::uint32_t point) {
        double nearest = 4.0 * bound;
        std::size_t home = 0;
        for (std::size_t i = 0; i < shapes.size() && nearest > enough; ++i) {
            const std::size_t s = (last + i) % shapes.size();
            const double d =
                squared_distance(input_[point], shapes[s][0], shapes[s][1], shapes[s][2]);
            if (d < nearest) {
                nearest = d;
                home = s;
            }
        }
        homes_.emplace_back(point, ring_[home]);
        last = home;
        return nearest <= bound;
    };
    for (const std::uint32_t end : {u, v}) {
        if (stamps_[end] == 0 && !place(end)) return false;
        for (const std::uint32_t t : fans_[end]) {
            if (end == v && has(t, u)) continue;
            for (const std::uint32_t point : carried_[t]) {
                if (!place(point)) return false;
            }
        }
    }
    return true;
}

bool Simplifier::try_collapse(std::uint32_t u, std::uint32_t v, const Vec3d& position) {
    if (!link_condition(u, v)) return false;
    if (!keeps_orientation(u, v, position) || !keeps_orientation(v, u, position)) return false;
    ring_.clear();
    for (const std::uint32_t t : fans_[u]) {
        if (!has(t, v)) ring_.push_back(t);
    }
    for (const std::uint32_t t : fans_[v]) {
        if (!has(t, u)) ring_.push_back(t);
    }
    if (folds_back(position, u, v) || !assign_points(position, u, v)) return false;
    collapse(u, v, position);
    return true;
}

void Simplifier::collapse(std::uint32_t u, std::uint32_t v, const Vec3d& position) {
    for (const std::uint32_t t : fans_[u]) {
        carried_[t].clear();
        if (!has(t, v)) continue;
        gone_[t] = 1;
        --left_;
        for (const std::uint32_t w : triangles_[t]) {
            if (w != u && w != v) std::erase(fans_[w], t);
        }
    }
    for (const std::uint32_t t : fans_[v]) {
        carried_[t].clear();
        std::replace(triangles_[t].begin(), triangles_[t].end(), v, u);
    }
    for (const auto& [point, home] : homes_) carried_[home].push_back(point);
    fans_[u] = ring_;
    fans_[v].clear();
    fans_[v].shrink_to_fit();
    quadrics_[u] += quadrics_[v];
    positions_[u] = position;
    ++stamps_[u];
    stamps_[v] = kNoIndex;
    for (const std::uint32_t t : ring_) mark_folded(t);
    for (const std::uint32_t w : neighbors(u)) push(u, w);
}

TriangleMesh Simplifier::run() {
    for (const Triangle& t : triangles_) {
        for (int k = 0; k < 3; ++k) {
            if (t[k] < t[(k + 1) % 3]) push(t[k], t[(k + 1) % 3]);
        }
    }
    while (!queue_.empty() && left_ > settings_.min_triangles) {
        const Candidate next = queue_.top();
        queue_.pop();
        if (stamps_[next.u] != next.u_stamp || stamps_[next.v] != next.v_stamp) continue;
        try_collapse(next.u, next.v, target(next.u, next.v).position);
    }
    TriangleMesh result;
    std::vector<std::uint32_t> place(positions_.size(), kNoIndex);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
        if (gone_[t] != 0) continue;
        Triangle corners{};
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t v = triangles_[t][k];
            if (place[v] == kNoIndex) {
                place[v] = static_cast<std::uint32_t>(result.vertices.size());
                result.vertices.push_back(positions_[v].cast<float>());
            }
            corners[k] = place[v];
        }
        result.triangles.push_back(corners);
    }
    return result;
}

}  // namespace

TriangleMesh simplify(const TriangleMesh& mesh, const SimplifySettings& settings) {
    if (!(settings.max_error > 0.0) || !std::isfinite(settings.max_error)) {
        throw InvalidInput("simplify: max_error must be positive");
    }
    return Simplifier(mesh, settings).run();
}

}  // namespace ostraka
