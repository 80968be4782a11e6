// SPDX-License-Identifier: Apache-2.0
// Depth scans of simple solids for tests: what a camera sees, at an even density, with normals, and
// which solid each point is of.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "ostraka/base/random.hpp"
#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/resample.hpp"

namespace ostraka::test_scans {

enum class Shape { box, ball, cylinder };

/// A solid around the origin of its frame: a box of half sides `half`, a ball of radius half.x, or
/// a cylinder about z of radius half.x and half length half.z.
struct Solid {
    Shape shape = Shape::box;
    Vec3d half = Vec3d::Ones();
    Pose T_world_solid = Pose::Identity();
};

inline Pose at(const Vec3d& place, double turn_about_z = 0.0) {
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(turn_about_z, Vec3d::UnitZ()).toRotationMatrix();
    pose.translation() = place;
    return pose;
}
inline Solid box(const Vec3d& half, const Vec3d& place, double turn = 0.0) {
    return {Shape::box, half, at(place, turn)};
}
inline Solid ball(double radius, const Vec3d& place) {
    return {Shape::ball, Vec3d::Constant(radius), at(place)};
}
/// Its axis along world z, or lying along world x.
inline Solid cylinder(double radius, double half_length, const Vec3d& place, bool lying = false) {
    Solid solid{Shape::cylinder, Vec3d(radius, radius, half_length), at(place)};
    if (lying) {
        solid.T_world_solid.linear() =
            Eigen::AngleAxisd(0.5 * kPi, Vec3d::UnitY()).toRotationMatrix();
    }
    return solid;
}
/// A table whose top is the plane z = 0.
inline Solid table(double half_side) {
    return box({half_side, half_side, 5.0}, {0.0, 0.0, -5.0});
}

struct Interval {
    double enter = -std::numeric_limits<double>::infinity();
    double leave = std::numeric_limits<double>::infinity();
    void cut(double a, double b) {
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    void miss() { leave = -std::numeric_limits<double>::infinity(); }
    // x x (dd) + 2 x (od) + oo <= 0
    void cut_quadratic(double dd, double od, double oo) {
        const double root = od * od - dd * oo;
        if (root < 0.0) return miss();
        cut((-od - std::sqrt(root)) / dd, (-od + std::sqrt(root)) / dd);
    }
};

/// Distance along the ray (unit direction) at which it enters the solid; infinity if it doesn't.
inline double enter(const Solid& solid, const Vec3d& eye, const Vec3d& direction) {
    const Vec3d o = solid.T_world_solid.inverse() * eye;
    const Vec3d d = solid.T_world_solid.linear().transpose() * direction;
    Interval inside;
    const auto slab = [&](int k) {
        inside.cut((-solid.half[k] - o[k]) / d[k], (solid.half[k] - o[k]) / d[k]);
    };
    const double square = solid.half.x() * solid.half.x();
    if (solid.shape == Shape::box) {
        for (int k = 0; k < 3; ++k) slab(k);
    } else if (solid.shape == Shape::ball) {
        inside.cut_quadratic(1.0, o.dot(d), o.squaredNorm() - square);
    } else {
        inside.cut_quadratic(d.head<2>().squaredNorm(), o.head<2>().dot(d.head<2>()),
                             o.head<2>().squaredNorm() - square);
        slab(2);
    }
    return inside.enter < inside.leave && inside.enter > 0.0
               ? inside.enter
               : std::numeric_limits<double>::infinity();
}

struct Scan {
    PointCloud cloud;                  ///< points about 1 apart, world frame
    std::vector<std::uint32_t> solid;  ///< of each point
};

/// @param noise  deviation along the line of sight, added to each point before normals are
/// estimated.
inline Scan scan(const std::vector<Solid>& solids, const Vec3d& eye, double noise,
                 std::uint64_t seed = 1, double half_width = 60.0) {
    constexpr double kPitch = 0.2;  // of rays at the origin
    const Vec3d forward = -eye.normalized();
    const Vec3d right = forward.cross(Vec3d(0.01, 0.02, 1.0)).normalized();
    const Vec3d up = right.cross(forward);
    const int n = static_cast<int>(half_width / kPitch);
    PointCloud raw;
    std::vector<std::uint32_t> solid_of_raw;
    for (int row = -n; row <= n; ++row) {
        for (int column = -n; column <= n; ++column) {
            const Vec3d direction = Vec3d(kPitch * (column * right + row * up) - eye).normalized();
            double nearest = std::numeric_limits<double>::infinity();
            std::uint32_t hit = 0;
            for (std::uint32_t s = 0; s < solids.size(); ++s) {
                const double distance = enter(solids[s], eye, direction);
                if (distance < nearest) {
                    nearest = distance;
                    hit = s;
                }
            }
            if (!std::isfinite(nearest)) continue;
            raw.points.push_back(Vec3d(eye + nearest * direction).cast<float>());
            solid_of_raw.push_back(hit);
        }
    }
    raw.viewpoint = eye.cast<float>();
    Scan result;
    result.cloud = resample(raw, 1.0);
    const KdTree tree(raw.points);
    for (const Vec3f& point : result.cloud.points) {
        result.solid.push_back(solid_of_raw[tree.nearest(point).index]);
    }
    Random random(seed);
    for (Vec3f& point : result.cloud.points) {
        const Vec3d ray = (point.cast<double>() - eye).normalized();
        point += Vec3d(noise * random.normal() * ray).cast<float>();
    }
    result.cloud.normals = estimate_normals_within(result.cloud, kNormalRadius);
    return result;
}

/// Intersection over union of a solid's points and a set.
inline double agreement(const Scan& scan, std::uint32_t solid,
                        const std::vector<std::uint32_t>& indices) {
    std::size_t common = 0;
    for (const std::uint32_t i : indices) common += scan.solid[i] == solid ? 1U : 0U;
    const auto all =
        static_cast<std::size_t>(std::count(scan.solid.begin(), scan.solid.end(), solid));
    return static_cast<double>(common) / static_cast<double>(all + indices.size() - common);
}

/// The best agreement of a solid with any of the sets.
inline double best_agreement(const Scan& scan, std::uint32_t solid,
                             const std::vector<std::vector<std::uint32_t>>& sets) {
    double best = 0.0;
    for (const auto& set : sets) best = std::max(best, agreement(scan, solid, set));
    return best;
}

}  // namespace ostraka::test_scans
