// SPDX-License-Identifier: Apache-2.0
// Distances of the primitives, after Quilez's collection of exact two- and three-dimensional
// distance functions; the link and the hull of two balls are exact as well.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "ostraka/base/error.hpp"
#include "ostraka/simulation/solid_node.hpp"

namespace ostraka {
namespace {

// A node around a function object, so that a primitive is one lambda.
template <typename Field>
struct Leaf final : Solid::Node {
    explicit Leaf(Field f) : field(std::move(f)) {}
    double distance(const Vec3d& p) const override { return field(p); }
    Field field;
};

template <typename Field>
Solid leaf(const Vec3d& low, const Vec3d& high, Field field) {
    return {std::make_shared<Leaf<Field>>(std::move(field)), Bounds3{low, high}};
}

template <typename Field>
Solid centered(const Vec3d& half, Field field) {
    return leaf(-half, half, std::move(field));
}

double length(double x, double y) {
    return std::sqrt(x * x + y * y);
}

// From the distance across (2D, signed) and along z to that of the prism.
double capped(double across, double z, double half_height) {
    const double along = std::abs(z) - half_height;
    const double outside = length(std::max(across, 0.0), std::max(along, 0.0));
    return std::min(std::max(across, along), 0.0) + outside;
}

// Signed distance to a simple polygon. For an outline turned around x = 0, edges on that axis are
// no surface.
template <bool kTurned>
double polygon_distance(const std::vector<Vec2d>& polygon, double x, double y) {
    double nearest = std::numeric_limits<double>::infinity();
    bool inside = false;
    for (std::size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++) {
        const Vec2d& a = polygon[last];
        const Vec2d& b = polygon[i];
        if (kTurned && a.x() <= 0.0 && b.x() <= 0.0) continue;
        const double ex = b.x() - a.x();
        const double ey = b.y() - a.y();
        const double px = x - a.x();
        const double py = y - a.y();
        const double t = std::clamp((px * ex + py * ey) / (ex * ex + ey * ey), 0.0, 1.0);
        const double dx = px - t * ex;
        const double dy = py - t * ey;
        nearest = std::min(nearest, dx * dx + dy * dy);
        // Parity of the edges met by a ray toward +x, which never meets the axis x = 0.
        if ((a.y() > y) != (b.y() > y) && (ex * py - ey * px > 0.0) == (ey > 0.0)) {
            inside = !inside;
        }
    }
    return (inside ? -1.0 : 1.0) * std::sqrt(nearest);
}

// Signed distance to the hull of two disks (or, turned around x, balls) at 0 and `gap` on the x
// axis. @param y at least 0.
struct DiskHull {
    DiskHull(double low, double high, double distance)
        : low_radius(low),
          high_radius(high),
          gap(distance),
          sine((low - high) / distance),
          cosine(std::sqrt(1.0 - sine * sine)) {}

    double operator()(double x, double y) const {
        const double along = cosine * x - sine * y;  // along the common tangent
        if (along < 0.0) return length(x, y) - low_radius;
        if (along > cosine * gap) return length(x - gap, y) - high_radius;
        return sine * x + cosine * y - low_radius;
    }

    double low_radius;
    double high_radius;
    double gap;
    double sine;
    double cosine;
};

Solid hull_of_balls(const SweepBall& a, const SweepBall& b) {
    const Vec3d axis = b.center - a.center;
    const double gap = axis.norm();
    require_positive(a.radius, "radius of a swept ball");
    require_positive(b.radius, "radius of a swept ball");
    require_positive(gap - std::abs(a.radius - b.radius), "step of a sweep beyond its own ball");
    const Vec3d low = (a.center.array() - a.radius).min(b.center.array() - b.radius);
    const Vec3d high = (a.center.array() + a.radius).max(b.center.array() + b.radius);
    return leaf(low, high,
                [origin = a.center, unit = Vec3d(axis / gap),
                 hull = DiskHull(a.radius, b.radius, gap)](const Vec3d& p) {
                    const Vec3d q = p - origin;
                    const double along = q.dot(unit);
                    return hull(along, (q - along * unit).norm());
                });
}

std::vector<Vec2d> checked_polygon(std::span<const Vec2d> polygon) {
    if (polygon.size() < 3) throw InvalidInput("a polygon needs at least 3 corners");
    std::vector<Vec2d> corners(polygon.begin(), polygon.end());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec2d edge = corners[(i + 1) % corners.size()] - corners[i];
        require_positive(edge.norm(), "every edge of a polygon");
    }
    return corners;
}

}  // namespace

void require_positive(double value, const char* what) {
    if (value > 0.0 && std::isfinite(value)) return;
    throw InvalidInput(std::string(what) + " must be positive");
}

Solid box(const Vec3d& size) {
    require_positive(size.minCoeff(), "size of a box");
    return centered(size / 2.0, [half = Vec3d(size / 2.0)](const Vec3d& p) {
        const Vec3d q = p.cwiseAbs() - half;
        return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
    });
}

Solid rounded_box(const Vec3d& size, double radius) {
    require_positive(radius, "radius of a rounded box");
    return grown(box(size - Vec3d::Constant(2.0 * radius)), radius);
}

Solid cylinder(double radius, double height) {
    require_positive(radius, "radius of a cylinder");
    require_positive(height, "height of a cylinder");
    return centered({radius, radius, height / 2.0}, [radius, half = height / 2.0](const Vec3d& p) {
        return capped(length(p.x(), p.y()) - radius, p.z(), half);
    });
}

Solid capped_cone(double low_radius, double high_radius, double height) {
    require_positive(std::max(low_radius, high_radius), "larger radius of a cone");
    require_positive(height, "height of a cone");
    if (std::min(low_radius, high_radius) < 0.0) throw InvalidInput("a cone radius is negative");
    const double h = height / 2.0;
    std::vector<Vec2d> outline{{0.0, -h}};
    if (low_radius > 0.0) outline.emplace_back(low_radius, -h);
    if (high_radius > 0.0) outline.emplace_back(high_radius, h);
    outline.emplace_back(0.0, h);
    return revolved(outline);
}

Solid sphere(double radius) {
    require_positive(radius, "radius of a sphere");
    return centered(Vec3d::Constant(radius),
                    [radius](const Vec3d& p) { return p.norm() - radius; });
}

Solid torus(double ring_radius, double tube_radius) {
    require_positive(tube_radius, "tube radius of a torus");
    require_positive(ring_radius - tube_radius, "hole of a torus");
    const double reach = ring_radius + tube_radius;
    return centered({reach, reach, tube_radius}, [ring_radius, tube_radius](const Vec3d& p) {
        return length(length(p.x(), p.y()) - ring_radius, p.z()) - tube_radius;
    });
}

Solid half_space(const Vec3d& normal, double offset) {
    const double size = normal.norm();
    require_positive(size, "length of a normal");
    const double infinity = std::numeric_limits<double>::infinity();
    return centered(Vec3d::Constant(infinity),
                    [unit = Vec3d(normal / size), offset = offset / size](const Vec3d& p) {
                        return unit.dot(p) - offset;
                    });
}

Solid extruded(std::span<const Vec2d> polygon, double height) {
    require_positive(height, "height of an extrusion");
    std::vector<Vec2d> corners = checked_polygon(polygon);
    Vec3d low(corners[0].x(), corners[0].y(), -height / 2.0);
    Vec3d high(corners[0].x(), corners[0].y(), height / 2.0);
    for (const Vec2d& corner : corners) {
        low.head<2>() = low.head<2>().cwiseMin(corner);
        high.head<2>() = high.head<2>().cwiseMax(corner);
    }
    return leaf(low, high, [corners = std::move(corners), half = height / 2.0](const Vec3d& p) {
        return capped(polygon_distance<false>(corners, p.x(), p.y()), p.z(), half);
    });
}

Solid revolved(std::span<const Vec2d> polygon) {
    std::vector<Vec2d> corners = checked_polygon(polygon);
    double reach = 0.0;
    double low = corners[0].y();
    double high = low;
    for (const Vec2d& corner : corners) {
        if (corner.x() < 0.0) throw InvalidInput("revolved: a radius is negative");
        reach = std::max(reach, corner.x());
        low = std::min(low, corner.y());
        high = std::max(high, corner.y());
    }
    return leaf({-reach, -reach, low}, {reach, reach, high},
                [corners = std::move(corners)](const Vec3d& p) {
                    return polygon_distance<true>(corners, length(p.x(), p.y()), p.z());
                });
}

Solid hexagonal_prism(double across_flats, double height) {
    require_positive(across_flats, "width of a hexagon");
    std::vector<Vec2d> corners;
    const double reach = across_flats / std::sqrt(3.0);
    for (int i = 0; i < 6; ++i) {
        const double angle = kPi / 6.0 + kPi / 3.0 * i;
        corners.emplace_back(reach * std::cos(angle), reach * std::sin(angle));
    }
    return extruded(corners, height);
}

Solid link(double low_radius, double high_radius, double distance, double height) {
    require_positive(std::min(low_radius, high_radius), "radius of a link");
    require_positive(height, "height of a link");
    require_positive(distance - std::abs(low_radius - high_radius), "free length of a link");
    const double wide = std::max(low_radius, high_radius);
    const Vec3d low(std::min(-low_radius, distance - high_radius), -wide, -height / 2.0);
    const Vec3d high(std::max(low_radius, distance + high_radius), wide, height / 2.0);
    return leaf(low, high,
                [hull = DiskHull(low_radius, high_radius, distance), half = height / 2.0](
                    const Vec3d& p) { return capped(hull(p.x(), std::abs(p.y())), p.z(), half); });
}

Solid swept(std::span<const SweepBall> balls) {
    if (balls.size() < 2) throw InvalidInput("swept: at least 2 balls are needed");
    std::vector<Solid> pieces;
    for (std::size_t i = 1; i < balls.size(); ++i) {
        pieces.push_back(hull_of_balls(balls[i - 1], balls[i]));
    }
    return unite(pieces);
}

}  // namespace ostraka
