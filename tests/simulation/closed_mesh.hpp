// SPDX-License-Identifier: Apache-2.0
// What tests ask of closed meshes. Written apart from the library, as an oracle.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

struct ClosedMeshReport {
    bool closed = false;      // every directed edge once, and its opposite once
    bool manifold = false;    // triangles around each vertex form one fan
    int components = 0;       // connected by edges
    int euler = 0;            // V - E + F
    int folds = 0;            // edges where the surface turns back by over 143 degrees
    int empty_triangles = 0;  // of no area
    double volume = 0.0;

    int genus() const { return components - euler / 2; }
};

inline int root_of(std::vector<int>& parent, int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
}

inline ClosedMeshReport examine(const TriangleMesh& mesh) {
    ClosedMeshReport report;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> edges;
    const auto vertices = static_cast<int>(mesh.vertices.size());
    std::vector<int> parent(mesh.vertices.size());
    std::iota(parent.begin(), parent.end(), 0);
    std::vector<std::map<std::uint32_t, std::uint32_t>> next(mesh.vertices.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& corners = mesh.triangles[t];
        std::array<Vec3d, 3> p;
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = corners[k];
            const std::uint32_t b = corners[(k + 1) % 3];
            edges[{a, b}].push_back(t);
            next[a][b] = corners[(k + 2) % 3];
            parent[root_of(parent, static_cast<int>(a))] = root_of(parent, static_cast<int>(b));
            p[k] = mesh.vertices[a].cast<double>();
        }
        report.volume += p[0].dot(p[1].cross(p[2])) / 6.0;
        report.empty_triangles += area_vector(mesh, corners).norm() == 0.0 ? 1 : 0;
    }
    report.closed = !edges.empty();
    for (const auto& [edge, users] : edges) {
        const auto opposite = edges.find({edge.second, edge.first});
        if (users.size() != 1 || opposite == edges.end() || edge.first == edge.second) {
            report.closed = false;
            continue;
        }
        const Vec3d a = area_vector(mesh, mesh.triangles[users[0]]);
        const Vec3d b = area_vector(mesh, mesh.triangles[opposite->second[0]]);
        if (edge.first < edge.second && a.dot(b) < -0.8 * a.norm() * b.norm()) ++report.folds;
    }
    report.manifold = report.closed;
    for (int v = 0; v < vertices; ++v) {
        report.components += root_of(parent, v) == v ? 1 : 0;
        if (!report.closed) continue;
        if (next[v].empty()) {
            report.manifold = false;  // a vertex without triangles
            continue;
        }
        std::size_t steps = 1;
        const std::uint32_t start = next[v].begin()->first;
        for (std::uint32_t w = next[v][start]; w != start; w = next[v][w]) ++steps;
        if (steps != next[v].size()) report.manifold = false;
    }
    report.euler =
        vertices - static_cast<int>(edges.size() / 2) + static_cast<int>(mesh.triangles.size());
    return report;
}

}  // namespace ostraka
