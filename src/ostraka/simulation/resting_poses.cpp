// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/resting_poses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ostraka {
namespace {

constexpr double kContact = 1e-6;  // of the radius: points so near the plane touch it
constexpr double kBalance = 1e-9;  // of the radius: so near the center of mass is supported

double cross(const Vec2d& a, const Vec2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// Convex hull, counter-clockwise. Andrew. Another efficient algorithm for convex hulls in two
// dimensions. 1979.
std::vector<Vec2d> convex_hull(std::vector<Vec2d> points) {
    std::sort(points.begin(), points.end(), [](const Vec2d& a, const Vec2d& b) {
        return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
    });
    std::vector<Vec2d> hull;
    for (int pass = 0; pass < 2; ++pass) {
        const std::size_t start = hull.size();
        for (const Vec2d& point : points) {
            while (hull.size() >= start + 2 &&
                   cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= 0.0) {
                hull.pop_back();
            }
            hull.push_back(point);
        }
        if (points.size() > 1) hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

// The point of the hull of points that is nearest to the origin: the origin itself if inside.
Vec2d nearest_of_hull(const std::vector<Vec2d>& points) {
    const std::vector<Vec2d> hull = convex_hull(points);
    bool inside = hull.size() > 2;
    Vec2d nearest = hull.front();
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vec2d& from = hull[i];
        const Vec2d along = hull[(i + 1) % hull.size()] - from;
        inside = inside && cross(from, along) >= 0.0;
        const double length2 = along.squaredNorm();
        const double t = length2 > 0.0 ? std::clamp(-from.dot(along) / length2, 0.0, 1.0) : 0.0;
        const Vec2d point = from + t * along;
        if (point.squaredNorm() < nearest.squaredNorm()) nearest = point;
    }
    return inside ? Vec2d(Vec2d::Zero()) : nearest;
}

// A shape on its way, by the points that are known to matter.
struct Roller {
    const RollingShape& shape;
    std::vector<Vec3d> points;    // of the hull, from the center of mass
    std::vector<double> depths;   // of each point below the lowest one: 0 or less
    double height = 0.0;          // of the center of mass above the plane
    Vec3d pivot = Vec3d::Zero();  // horizontal, from the center of mass to the nearest support

    double tolerance() const { return kContact * shape.radius; }
};

// Finds what touches the plane, if `down` is down, among the known points.
void touch(Roller& roller, const Vec3d& down) {
    roller.height = -std::numeric_limits<double>::infinity();
    roller.depths.clear();
    for (const Vec3d& point : roller.points) {
        roller.depths.push_back(down.dot(point));
        roller.height = std::max(roller.height, roller.depths.back());
    }
    const Vec3d u = down.unitOrthogonal();
    const Vec3d v = down.cross(u);
    std::vector<Vec2d> supports;
    for (std::size_t i = 0; i < roller.points.size(); ++i) {
        roller.depths[i] -= roller.height;
        if (roller.depths[i] < -roller.tolerance()) continue;
        supports.emplace_back(u.dot(roller.points[i]), v.dot(roller.points[i]));
    }
    const Vec2d nearest = nearest_of_hull(supports);
    roller.pivot = nearest.x() * u + nearest.y() * v;
}

// Takes in the vertex that reaches deepest. False if it is no deeper than those known.
bool meet_deepest(Roller& roller, const Vec3d& down) {
    const Vec3d deepest = extreme_vertex(roller.shape, down);
    double known = -std::numeric_limits<double>::infinity();
    for (const Vec3d& point : roller.points) known = std::max(known, down.dot(point));
    if (down.dot(deepest) <= known + roller.tolerance()) return false;
    roller.points.push_back(deepest);
    return true;
}

// What is down after turning away from the pivot until the next known point touches; `down` if none
// will. Along that arc, down(t) = down cos t - q sin t with q the pivot's direction, and point p is
// in the plane of the pivot where a cos t - b sin t = 0, a its depth, b = q . p - |pivot|.
Vec3d rolled(const Roller& roller, const Vec3d& down) {
    const double length = roller.pivot.norm();
    const Vec3d q = roller.pivot / length;
    double best = -std::numeric_limits<double>::infinity();  // cot t
    for (std::size_t i = 0; i < roller.points.size(); ++i) {
        const double a = roller.depths[i];
        if (a >= -roller.tolerance()) continue;  // in contact, and lifting off
        best = std::max(best, (q.dot(roller.points[i]) - length) / a);
    }
    if (!std::isfinite(best)) return down;
    return (best * down - q).normalized();  // times sin t, which is above 0
}

}  // namespace

RestingPose roll_to_rest(const RollingShape& shape, const Mat3d& R_world_model, int max_rolls) {
    RestingPose pose;
    Roller roller{.shape = shape, .points = shape.points};
    Vec3d down = R_world_model.transpose() * -Vec3d::UnitZ();
    meet_deepest(roller, down);
    touch(roller, down);
    for (;;) {
        pose.at_rest = roller.pivot.norm() <= kBalance * shape.radius;
        if (pose.at_rest || pose.rolls >= max_rolls) break;
        const Vec3d next = rolled(roller, down);
        if (next == down) break;
        // A vertex deeper than the points known has been passed: it touches before.
        if (!meet_deepest(roller, next)) {
            down = next;
            ++pose.rolls;
        }
        touch(roller, down);
    }
    pose.height = roller.height;
    const Eigen::Vector3d from = R_world_model * down;
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond::FromTwoVectors(from, Eigen::Vector3d(0.0, 0.0, -1.0));
    pose.R_world_model = turn.normalized().toRotationMatrix() * R_world_model;
    return pose;
}

}  // namespace ostraka
