// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/repair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

void check_input(const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) {
        throw InvalidInput(
            fmt::format("mesh has no triangles ({} vertices)", mesh.vertices.size()));
    }
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        if (!mesh.vertices[i].allFinite()) {
            throw InvalidInput(fmt::format("mesh vertex {} is not finite", i));
        }
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (const std::uint32_t vertex : mesh.triangles[i]) {
            if (vertex >= mesh.vertices.size()) {
                throw InvalidInput(fmt::format("mesh triangle {} names vertex {} of {}", i, vertex,
                                               mesh.vertices.size()));
            }
        }
    }
}

// For each vertex the first vertex at the same place.
std::vector<std::uint32_t> find_twins(const std::vector<Vec3f>& vertices) {
    std::vector<std::uint32_t> order(vertices.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
        const Vec3f& p = vertices[a];
        const Vec3f& q = vertices[b];
        return std::tie(p.x(), p.y(), p.z(), a) < std::tie(q.x(), q.y(), q.z(), b);
    };
    std::sort(order.begin(), order.end(), before);
    std::vector<std::uint32_t> twin(vertices.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
        twin[order[i]] = same ? twin[order[i - 1]] : order[i];
    }
    return twin;
}

}  // namespace

RepairResult repair(const TriangleMesh& mesh) {
    check_input(mesh);
    const std::vector<std::uint32_t> twin = find_twins(mesh.vertices);
    RepairResult result;
    std::vector<std::uint32_t> new_index(mesh.vertices.size(), kNoIndex);
    for (const Triangle& old : mesh.triangles) {
        Triangle triangle = {twin[old[0]], twin[old[1]], twin[old[2]]};
        if (!(area_vector(mesh, triangle).norm() > 0.0)) {
            ++result.degenerate_triangles;
            continue;
        }
        for (std::uint32_t& vertex : triangle) {
            if (new_index[vertex] == kNoIndex) {
                new_index[vertex] = static_cast<std::uint32_t>(result.mesh.vertices.size());
                result.mesh.vertices.push_back(mesh.vertices[vertex]);
            }
            vertex = new_index[vertex];
        }
        result.mesh.triangles.push_back(triangle);
    }
    for (std::uint32_t i = 0; i < twin.size(); ++i) result.welded_vertices += twin[i] != i ? 1 : 0;
    if (result.mesh.triangles.empty()) {
        throw InvalidInput(
            fmt::format("all {} mesh triangles have zero area", mesh.triangles.size()));
    }
    return result;
}

}  // namespace ostraka
