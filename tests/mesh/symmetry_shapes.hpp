// SPDX-License-Identifier: Apache-2.0
// Meshes whose symmetry is known, for tests.
#pragma once

#include <functional>
#include <numeric>

#include "mesh/test_meshes.hpp"

namespace ostraka::test_meshes {

/// The triangles of both.
inline TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
    const auto offset = static_cast<std::uint32_t>(a.vertices.size());
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (Triangle triangle : b.triangles) {
        for (std::uint32_t& corner : triangle) corner += offset;
        a.triangles.push_back(triangle);
    }
    return a;
}

/// A polygon in xy, counter-clockwise, all of which can be seen from `eye`, from z = low to high.
inline TriangleMesh extruded(const std::vector<Vec2d>& polygon, double low, double high,
                             const Vec2d& eye = Vec2d::Zero()) {
    TriangleMesh mesh;
    const auto n = static_cast<std::uint32_t>(polygon.size());
    for (const double z : {low, high}) {
        for (const Vec2d& p : polygon) {
            mesh.vertices.push_back(Vec3d(p.x(), p.y(), z).cast<float>());
        }
        mesh.vertices.push_back(Vec3d(eye.x(), eye.y(), z).cast<float>());
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = (i + 1) % n;
        const std::uint32_t up = n + 1;
        mesh.triangles.push_back({i, j, up + j});
        mesh.triangles.push_back({i, up + j, up + i});
        mesh.triangles.push_back({n, j, i});
        mesh.triangles.push_back({up + n, up + i, up + j});
    }
    return mesh;
}

/// Corners of the curve radius(angle).
inline std::vector<Vec2d> curve(int corners, const std::function<double(double)>& radius) {
    std::vector<Vec2d> polygon;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2.0 * kPi * i / corners;
        polygon.emplace_back(radius(angle) * std::cos(angle), radius(angle) * std::sin(angle));
    }
    return polygon;
}

inline TriangleMesh prism(int sides, double radius, double low, double high) {
    return extruded(curve(sides, [=](double) { return radius; }), low, high);
}

/// Teeth with straight flanks. @param skew  leans each tooth, which leaves no half turn across.
inline TriangleMesh gear(int teeth, double inner, double outer, double width, double skew = 0.0) {
    std::vector<Vec2d> polygon;
    for (int i = 0; i < teeth; ++i) {
        for (const auto& [part, radius] : {std::pair(0.0, inner), std::pair(0.3 + skew, outer),
                                           std::pair(0.55 + skew, outer), std::pair(0.85, inner)}) {
            const double angle = 2.0 * kPi * (i + part) / teeth;
            polygon.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
        }
    }
    return extruded(polygon, -0.5 * width, 0.5 * width);
}

/// The closed curve (radius, z), counter-clockwise, turned about z.
inline TriangleMesh revolved(const std::vector<Vec2d>& profile, int segments) {
    TriangleMesh mesh;
    const auto n = static_cast<std::uint32_t>(profile.size());
    for (int s = 0; s < segments; ++s) {
        const double angle = 2.0 * kPi * s / segments;
        for (const Vec2d& p : profile) {
            mesh.vertices.push_back(
                Vec3d(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y()).cast<float>());
        }
    }
    for (std::uint32_t s = 0; s < static_cast<std::uint32_t>(segments); ++s) {
        const std::uint32_t here = s * n;
        const std::uint32_t next = (s + 1) % static_cast<std::uint32_t>(segments) * n;
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t j = (i + 1) % n;
            if (profile[i].x() > 0.0) mesh.triangles.push_back({here + i, next + i, next + j});
            if (profile[j].x() > 0.0) mesh.triangles.push_back({here + i, next + j, here + j});
        }
    }
    return mesh;
}

inline TriangleMesh torus(double ring, double tube) {
    std::vector<Vec2d> profile = curve(40, [=](double) { return tube; });
    for (Vec2d& p : profile) p.x() += ring;
    return revolved(profile, 90);
}

inline TriangleMesh tetrahedron() {
    TriangleMesh mesh;
    mesh.vertices = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
    return mesh;
}

inline TriangleMesh octahedron() {
    TriangleMesh mesh;
    mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                      {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    return mesh;
}

inline TriangleMesh icosahedron() {
    TriangleMesh mesh;
    const float g = 1.6180339887F;
    mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                     {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    return mesh;
}

/// The same surface in other triangles: each is cut at random points of its sides and inside, over
/// and over, very unevenly.
inline TriangleMesh remeshed(TriangleMesh mesh, std::uint64_t seed) {
    Random random(seed);
    for (int i = 0; i < 1500; ++i) {
        const auto t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
        const Triangle old = mesh.triangles[t];
        double a = random.uniform(0.1, 1.0);
        double b = random.uniform(0.1, 1.0);
        double c = random.uniform(0.1, 1.0);
        const double sum = a + b + c;
        a /= sum, b /= sum, c /= sum;
        mesh.vertices.push_back(Vec3d(a * mesh.vertices[old[0]].cast<double>() +
                                      b * mesh.vertices[old[1]].cast<double>() +
                                      c * mesh.vertices[old[2]].cast<double>())
                                    .cast<float>());
        const auto middle = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
        mesh.triangles[t] = {old[0], old[1], middle};
        mesh.triangles.push_back({old[1], old[2], middle});
        mesh.triangles.push_back({old[2], old[0], middle});
    }
    return mesh;
}

}  // namespace ostraka::test_meshes
