// SPDX-License-Identifier: Apache-2.0
// Constructive solid geometry by signed distance functions, in double.
// Hart. Sphere Tracing: A Geometric Method for the Antialiased Ray Tracing of Implicit Surfaces.
// The Visual Computer 12, 1996. Smooth union: Quilez's quadratic polynomial blend.
// Every field here changes by at most 1 per unit of length (Lipschitz), also after any operation.
// So |distance(p)| never exceeds the true distance, and a ball around p can be judged by one value.
#pragma once

#include <initializer_list>
#include <memory>
#include <span>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// An axis-aligned box; infinite where a solid is unbounded, low > high where it is empty.
struct Bounds3 {
    Vec3d low;
    Vec3d high;
};

/// An immutable solid; copies are cheap and share their parts. Safe to read from many threads.
class Solid {
  public:
    /// The inside of a tree of fields; its definition is private to solid.cpp.
    struct Node;

    Solid(std::shared_ptr<const Node> node, const Bounds3& bounds);

    /// Negative inside, positive outside, 0 on the surface; at most the true distance in size.
    double distance(const Vec3d& point) const;
    /// Unit direction in which the distance grows, by central differences of +-`step`.
    Vec3d gradient(const Vec3d& point, double step) const;
    /// Contains the solid; not always tight.
    const Bounds3& bounds() const { return bounds_; }
    /// A solid with bit-identical distances inside the ball, without what cannot matter there.
    Solid specialized(const Vec3d& center, double radius) const;
    const std::shared_ptr<const Node>& node() const { return node_; }

  private:
    std::shared_ptr<const Node> node_;
    Bounds3 bounds_;
};

// Primitives. Centered at the origin and, where they have an axis, along z, unless stated.
// All throw InvalidInput if a size is not positive and finite.

Solid box(const Vec3d& size);
/// A box with all edges rounded. @param size outer size, above 2 radius on each axis.
Solid rounded_box(const Vec3d& size, double radius);
Solid cylinder(double radius, double height);
/// @param low_radius, high_radius  at z = -height / 2 and +height / 2; at least 0, not both 0.
Solid capped_cone(double low_radius, double high_radius, double height);
Solid sphere(double radius);
/// @param ring_radius  from the z axis to the middle of the tube; above tube_radius.
Solid torus(double ring_radius, double tube_radius);
/// All points with normal . p <= offset. @param normal any length but 0.
Solid half_space(const Vec3d& normal, double offset);
/// A polygon in xy, along z. @param polygon at least 3 corners, simple, either direction.
Solid extruded(std::span<const Vec2d> polygon, double height);
/// A polygon in (radius, z) turned around z. @param polygon as in extruded(); radius at least 0.
Solid revolved(std::span<const Vec2d> polygon);
/// @param across_flats  between opposite faces, of which two look along +-x.
Solid hexagonal_prism(double across_flats, double height);
/// The hull of a disk at the origin and one at (distance, 0), along z: the body of a lever.
/// @param distance  above |low_radius - high_radius|.
Solid link(double low_radius, double high_radius, double distance, double height);

/// One ball of a sweep.
struct SweepBall {
    Vec3d center;
    double radius;
};
/// The union of the hulls of successive balls: a bent bar of varying thickness.
/// @param balls  at least 2; no ball may hold its successor.
Solid swept(std::span<const SweepBall> balls);

// Operations.

/// @throws InvalidInput if there are no solids.
Solid unite(std::span<const Solid> solids);
Solid unite(std::initializer_list<Solid> solids);
Solid intersect(const Solid& a, const Solid& b);
/// a without b.
Solid subtract(const Solid& a, const Solid& b);
/// Union with concave edges filled. @param blend reach of the fillet along both surfaces; above 0.
Solid smooth_unite(const Solid& a, const Solid& b, double blend);
/// The solid with its surface moved outward by `offset`, which rounds convex edges; at least 0.
Solid grown(const Solid& solid, double offset);
Solid moved(const Solid& solid, const Vec3d& translation);
/// Turned around an axis through the origin, by `angle` radians, counter-clockwise. @param axis not
/// 0.
Solid rotated(const Solid& solid, const Vec3d& axis, double angle);
/// The solid and its mirror image at the plane where coordinate `axis` (0, 1, 2) is 0.
Solid with_mirror(const Solid& solid, int axis);
/// `count` copies turned around z in equal steps, the first in place. @param count at least 1.
Solid circular(const Solid& solid, int count);

}  // namespace ostraka
