// SPDX-License-Identifier: Apache-2.0
// How deep placed meshes are inside each other, and how far apart: by rays and by brute force.
// Written apart from the library's height maps, as an oracle.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "ostraka/base/random.hpp"
#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

// Ericson. Real-Time Collision Detection. 2005, section 5.1.5.
inline double distance_to_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const auto to_segment = [&](const Vec3d& from, const Vec3d& to) {
        const Vec3d along = to - from;
        const double length2 = along.squaredNorm();
        const double t =
            length2 > 0.0 ? std::clamp((p - from).dot(along) / length2, 0.0, 1.0) : 0.0;
        return (p - from - t * along).norm();
    };
    const Vec3d normal = (b - a).cross(c - a);
    const bool above = normal.squaredNorm() > 0.0 && normal.dot((b - a).cross(p - a)) >= 0.0 &&
                       normal.dot((c - b).cross(p - b)) >= 0.0 &&
                       normal.dot((a - c).cross(p - c)) >= 0.0;
    if (above) return std::abs(normal.dot(p - a)) / normal.norm();
    return std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}

// Inside or outside of a mesh by the parity of crossings along one direction. The triangles stand
// in a grid across that direction.
class RayParity {
  public:
    RayParity(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& triangles,
              const Mat3d& R)
        : R_(R), triangles_(triangles) {
        low_ = Vec3d::Constant(std::numeric_limits<double>::infinity());
        Vec3d high = -low_;
        for (const Vec3d& v : vertices) {
            turned_.emplace_back(R * v);
            low_ = low_.cwiseMin(turned_.back());
            high = high.cwiseMax(turned_.back());
        }
        step_ = std::max(high.x() - low_.x(), high.y() - low_.y()) / (kSide - 1);
        buckets_.resize(kSide * kSide);
        for (std::uint32_t t = 0; t < triangles.size(); ++t) {
            std::array<int, 4> range{kSide, -1, kSide, -1};
            for (const std::uint32_t v : triangles[t]) {
                const auto [x, y] = bucket(turned_[v]);
                range = {std::min(range[0], x), std::max(range[1], x), std::min(range[2], y),
                         std::max(range[3], y)};
            }
            for (int y = range[2]; y <= range[3]; ++y) {
                for (int x = range[0]; x <= range[1]; ++x) {
                    buckets_[static_cast<std::size_t>(y * kSide + x)].push_back(t);
                }
            }
        }
    }

    bool inside(const Vec3d& point) const {
        const Vec3d p = R_ * point;
        const auto [x, y] = bucket(p);
        if (x < 0 || y < 0 || x >= kSide || y >= kSide) return false;
        bool odd = false;
        for (const std::uint32_t t : buckets_[static_cast<std::size_t>(y * kSide + x)]) {
            const Vec3d a = turned_[triangles_[t][0]] - p;
            const Vec3d b = turned_[triangles_[t][1]] - p;
            const Vec3d c = turned_[triangles_[t][2]] - p;
            const double wa = b.x() * c.y() - b.y() * c.x();
            const double wb = c.x() * a.y() - c.y() * a.x();
            const double wc = a.x() * b.y() - a.y() * b.x();
            if (!((wa > 0 && wb > 0 && wc > 0) || (wa < 0 && wb < 0 && wc < 0))) continue;
            if ((wa * a.z() + wb * b.z() + wc * c.z()) / (wa + wb + wc) > 0.0) odd = !odd;
        }
        return odd;
    }

  private:
    static constexpr int kSide = 100;

    std::pair<int, int> bucket(const Vec3d& p) const {
        return {static_cast<int>(std::floor((p.x() - low_.x()) / step_)),
                static_cast<int>(std::floor((p.y() - low_.y()) / step_))};
    }

    Mat3d R_;
    const std::vector<Triangle>& triangles_;
    std::vector<Vec3d> turned_;
    Vec3d low_;
    double step_ = 0.0;
    std::vector<std::vector<std::uint32_t>> buckets_;
};

// A mesh where it was placed. The mesh must outlive it.
class PlacedMesh {
  public:
    PlacedMesh(const TriangleMesh& mesh, const Pose& T_world_model) : triangles_(mesh.triangles) {
        low = Vec3d::Constant(std::numeric_limits<double>::infinity());
        high = -low;
        for (const Vec3f& v : mesh.vertices) {
            vertices.emplace_back(T_world_model * v.cast<double>());
            low = low.cwiseMin(vertices.back());
            high = high.cwiseMax(vertices.back());
        }
        for (std::uint64_t i = 0; i < 3; ++i) {
            rays_.emplace_back(vertices, triangles_, Random(77, i).rotation());
        }
    }
    PlacedMesh(const PlacedMesh&) = delete;
    PlacedMesh(PlacedMesh&&) = default;

    // Rays are quick, but go wrong at the many edges of more than two triangles that scanned models
    // have. So where any of three has the point inside, the winding number decides.
    bool inside(const Vec3d& p) const {
        if ((p.array() < low.array()).any() || (p.array() > high.array()).any()) return false;
        return std::any_of(rays_.begin(), rays_.end(),
                           [&](const RayParity& ray) { return ray.inside(p); }) &&
               std::abs(winding_number(p)) > 0.5;
    }

    // Jacobson, Kavan, Sorkine-Hornung. Robust Inside-Outside Segmentation using Generalized
    // Winding Numbers. 2013. A triangle's solid angle after Van Oosterom and Strackee, 1983.
    double winding_number(const Vec3d& p) const {
        double sum = 0.0;
        for (const Triangle& t : triangles_) {
            const Vec3d a = vertices[t[0]] - p;
            const Vec3d b = vertices[t[1]] - p;
            const Vec3d c = vertices[t[2]] - p;
            const double la = a.norm();
            const double lb = b.norm();
            const double lc = c.norm();
            sum += 2.0 * std::atan2(a.dot(b.cross(c)),
                                    la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
        }
        return sum / (4.0 * kPi);
    }

    // From a point to the surface.
    double distance(const Vec3d& p) const {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Triangle& t : triangles_) {
            const Vec3d& a = vertices[t[0]];
            const Vec3d& b = vertices[t[1]];
            const Vec3d& c = vertices[t[2]];
            const Vec3d below = a.cwiseMin(b).cwiseMin(c) - p;
            const Vec3d above = p - a.cwiseMax(b).cwiseMax(c);
            if (below.cwiseMax(above).maxCoeff() >= nearest) continue;
            nearest = std::min(nearest, distance_to_triangle(p, a, b, c));
        }
        return nearest;
    }

    // All vertices, and random points of the surface, about one for each spacing^2.
    std::vector<Vec3d> surface_points(double spacing) const {
        std::vector<Vec3d> points = vertices;
        Random random(11);
        double credit = 0.0;
        for (const Triangle& t : triangles_) {
            const Vec3d u = vertices[t[1]] - vertices[t[0]];
            const Vec3d v = vertices[t[2]] - vertices[t[0]];
            for (credit += 0.5 * u.cross(v).norm() / (spacing * spacing); credit >= 1.0; --credit) {
                const double s = std::sqrt(random.uniform());
                const double r = random.uniform();
                points.emplace_back(vertices[t[0]] + s * (1.0 - r) * u + s * r * v);
            }
        }
        return points;
    }

    std::vector<Vec3d> vertices;  // world
    Vec3d low;
    Vec3d high;

  private:
    const std::vector<Triangle>& triangles_;
    std::vector<RayParity> rays_;
};

// How deep points of one surface are inside another mesh: the largest distance to its surface.
inline double depth_inside(const std::vector<Vec3d>& points, const PlacedMesh& other) {
    double deepest = 0.0;
    for (const Vec3d& point : points) {
        if (other.inside(point)) deepest = std::max(deepest, other.distance(point));
    }
    return deepest;
}

// The same over all pairs.
inline double deepest_overlap(const std::vector<PlacedMesh>& placed, double spacing) {
    double deepest = 0.0;
    for (std::size_t i = 0; i < placed.size(); ++i) {
        const std::vector<Vec3d> points = placed[i].surface_points(spacing);
        for (std::size_t j = 0; j < placed.size(); ++j) {
            if (i != j) deepest = std::max(deepest, depth_inside(points, placed[j]));
        }
    }
    return deepest;
}

}  // namespace ostraka
