// SPDX-License-Identifier: Apache-2.0
// A triangle mesh: the CAD model of an object, in its own frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

using Triangle = std::array<std::uint32_t, 3>;

struct TriangleMesh {
    std::vector<Vec3f> vertices;      ///< model frame, any unit
    std::vector<Triangle> triangles;  ///< indices into vertices, counter-clockwise from outside
};

/// Twice the area times the unit normal of a triangle: (b - a) x (c - a).
Vec3d area_vector(const TriangleMesh& mesh, const Triangle& triangle);

/// Sum of the triangles' areas, in the mesh's unit squared.
double surface_area(const TriangleMesh& mesh);

/// The mesh with every vertex multiplied by `factor`.
TriangleMesh scaled(TriangleMesh mesh, double factor);

/// The mesh moved by T_new_old.
TriangleMesh transformed(TriangleMesh mesh, const Pose& T_new_old);

}  // namespace ostraka
