// SPDX-License-Identifier: Apache-2.0
// Meshes of known shape for tests, closed and wound counter-clockwise from outside.
#pragma once

#include <cmath>
#include <cstdint>

#include "ostraka/base/random.hpp"
#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka::test_meshes {

/// A box with half sides `half` around the origin: 8 vertices, 12 triangles.
inline TriangleMesh box(const Vec3f& half) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < 8; ++i) {
        mesh.vertices.emplace_back((i & 1U) != 0U ? half.x() : -half.x(),
                                   (i & 2U) != 0U ? half.y() : -half.y(),
                                   (i & 4U) != 0U ? half.z() : -half.z());
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

/// The surface r(direction) over the unit sphere, in rings between two poles on the z axis.
template <class Radius>
TriangleMesh star_shape(int rings, int segments, const Radius& radius) {
    TriangleMesh mesh;
    const auto add = [&](double polar, double azimuth) {
        const Vec3d direction(std::sin(polar) * std::cos(azimuth),
                              std::sin(polar) * std::sin(azimuth), std::cos(polar));
        mesh.vertices.push_back(Vec3d(radius(direction) * direction).cast<float>());
    };
    add(0.0, 0.0);
    for (int i = 1; i < rings; ++i) {
        for (int j = 0; j < segments; ++j) add(kPi * i / rings, 2.0 * kPi * j / segments);
    }
    add(kPi, 0.0);
    const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    const auto at = [&](int ring, int segment) {
        return static_cast<std::uint32_t>(1 + (ring - 1) * segments + segment % segments);
    };
    for (int j = 0; j < segments; ++j) {
        mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
        for (int i = 1; i + 1 < rings; ++i) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
        mesh.triangles.push_back({at(rings - 1, j), last, at(rings - 1, j + 1)});
    }
    return mesh;
}

inline TriangleMesh sphere(double radius, int rings = 60) {
    return star_shape(rings, 2 * rings, [=](const Vec3d&) { return radius; });
}

/// A lopsided ellipsoid, about 10 x 6 x 4, without any symmetry: its canonical axes are unique.
inline TriangleMesh lopsided(int rings = 40) {
    return star_shape(rings, 2 * rings, [](const Vec3d& d) {
        const double base = 1.0 / d.cwiseQuotient(Vec3d(5.0, 3.0, 2.0)).norm();
        return base * (1.0 + 0.25 * d.x() + 0.15 * d.y() + 0.1 * d.z() + 0.1 * std::sin(4 * d.y()));
    });
}

/// `count` separate triangles with corners uniform in the cube [-1, 1]^3.
inline TriangleMesh random_triangles(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < 3 * count; ++i) {
        const Vec3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        mesh.vertices.push_back(p.cast<float>());
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return mesh;
}

inline Pose random_pose(std::uint64_t seed, double reach = 3.0) {
    Random random(seed);
    Pose pose = Pose::Identity();
    pose.linear() = random.rotation();
    for (int axis = 0; axis < 3; ++axis) pose.translation()[axis] = random.uniform(-reach, reach);
    return pose;
}

}  // namespace ostraka::test_meshes
