// SPDX-License-Identifier: Apache-2.0
// Small models made by hand, quick to look at from all sides, and without symmetry.
#pragma once

#include <vector>

#include "ostraka/library/build.hpp"

namespace ostraka::testing {

/// An axis-aligned box from `low` to `high`, outward oriented, added to a mesh.
inline void add_box(TriangleMesh& mesh, const Vec3f& low, const Vec3f& high) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (unsigned corner = 0; corner < 8; ++corner) {
        mesh.vertices.emplace_back((corner & 1U) != 0 ? high.x() : low.x(),
                                   (corner & 2U) != 0 ? high.y() : low.y(),
                                   (corner & 4U) != 0 ? high.z() : low.z());
    }
    const std::vector<Triangle> faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                         {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                         {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    for (const Triangle& face : faces) {
        mesh.triangles.push_back({first + face[0], first + face[1], first + face[2]});
    }
}

/// Three boxes of different lengths along the axes, with a stub: no rotation maps it onto itself.
inline TriangleMesh corner_model() {
    TriangleMesh mesh;
    add_box(mesh, Vec3f(0, 0, 0), Vec3f(80, 20, 20));
    add_box(mesh, Vec3f(0, 20, 0), Vec3f(20, 60, 20));
    add_box(mesh, Vec3f(0, 0, 20), Vec3f(20, 20, 45));
    add_box(mesh, Vec3f(60, 20, 5), Vec3f(70, 30, 15));
    return mesh;
}

/// A plate with two pillars of different height and a rib.
inline TriangleMesh plate_model() {
    TriangleMesh mesh;
    add_box(mesh, Vec3f(0, 0, 0), Vec3f(90, 60, 8));
    add_box(mesh, Vec3f(5, 5, 8), Vec3f(20, 20, 40));
    add_box(mesh, Vec3f(60, 35, 8), Vec3f(85, 50, 25));
    add_box(mesh, Vec3f(25, 10, 8), Vec3f(80, 14, 18));
    return mesh;
}

inline std::vector<ModelSource> simple_models() {
    return {{.name = "corner", .mesh = corner_model()}, {.name = "plate", .mesh = plate_model()}};
}

/// Few views and directions: a library in well under a second.
inline LibrarySettings quick_settings() {
    LibrarySettings settings;
    settings.sampling = 2.0;
    settings.views.count = 20;
    settings.cuts.directions = 6;
    settings.cuts.fractions = {0.5, 0.75};
    settings.selection.budget = 24;
    return settings;
}

}  // namespace ostraka::testing
