// SPDX-License-Identifier: Apache-2.0
// Where a ray meets a triangle, worked out in another way than the product's.
#pragma once

#include <algorithm>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka::testing {

struct OracleHit {
    double distance = 0.0;  ///< ray parameter of the triangle's plane
    double edge = 0.0;  ///< least barycentric coordinate: how far inside, negative where it misses
};

/// Moeller, Trumbore. Fast, Minimum Storage Ray/Triangle Intersection. 1997; in double precision.
inline OracleHit ray_oracle(const TriangleMesh& mesh, const Triangle& triangle, const Vec3d& origin,
                            const Vec3d& direction) {
    const Vec3d a = mesh.vertices[triangle[0]].cast<double>();
    const Vec3d ab = mesh.vertices[triangle[1]].cast<double>() - a;
    const Vec3d ac = mesh.vertices[triangle[2]].cast<double>() - a;
    const Vec3d p = direction.cross(ac);
    const double determinant = ab.dot(p);
    const Vec3d from = origin - a;
    const double u = from.dot(p) / determinant;
    const Vec3d q = from.cross(ab);
    const double v = direction.dot(q) / determinant;
    return {ac.dot(q) / determinant, std::min({u, v, 1.0 - u - v})};
}

}  // namespace ostraka::testing
