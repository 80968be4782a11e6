// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/raster_mesh.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

// Every second bit free for another coordinate, twice: ten bits on places 0, 3, 6, ...
std::uint32_t spread_bits(std::uint32_t value) {
    value = (value | (value << 16U)) & 0x030000ffU;
    value = (value | (value << 8U)) & 0x0300f00fU;
    value = (value | (value << 4U)) & 0x030c30c3U;
    return (value | (value << 2U)) & 0x09249249U;
}

// Used vertices along Morton's curve.
std::vector<std::uint32_t> vertex_order(const TriangleMesh& mesh) {
    Vec3f low = Vec3f::Constant(std::numeric_limits<float>::infinity());
    Vec3f high = -low;
    std::vector<bool> used(mesh.vertices.size(), false);
    for (const Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t v : triangle) {
            used[v] = true;
            low = low.cwiseMin(mesh.vertices[v]);
            high = high.cwiseMax(mesh.vertices[v]);
        }
    }
    const float side = std::max((high - low).maxCoeff(), std::numeric_limits<float>::min());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> codes;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        if (!used[v]) continue;
        std::uint32_t code = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const float place = (mesh.vertices[v][axis] - low[axis]) / side;
            code |= spread_bits(static_cast<std::uint32_t>(place * 1023.0F)) << unsigned(axis);
        }
        codes.emplace_back(code, v);
    }
    std::sort(codes.begin(), codes.end());
    std::vector<std::uint32_t> order(codes.size());
    std::transform(codes.begin(), codes.end(), order.begin(), [](auto& c) { return c.second; });
    return order;
}

}  // namespace

RasterMesh raster_mesh(const TriangleMesh& mesh) {
    const std::vector<std::uint32_t> order = vertex_order(mesh);
    std::vector<std::uint32_t> place(mesh.vertices.size(), kNoIndex);
    RasterMesh result;
    const std::size_t filled = (order.size() + kVectorLanes - 1) / kVectorLanes * kVectorLanes;
    for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float>& column = result.vertices[static_cast<std::size_t>(axis)];
        column.reserve(filled);
        for (const std::uint32_t v : order) column.push_back(mesh.vertices[v][axis]);
        column.resize(filled, column.front());
    }
    for (const Triangle& corners : mesh.triangles) {
        Triangle triangle = {place[corners[0]], place[corners[1]], place[corners[2]]};
        // Turned, not mirrored: the lowest index first.
        std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()),
                    triangle.end());
        result.triangles.push_back(triangle);
        for (int k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
            result.edges.push_back({low, high});
        }
    }
    std::sort(result.triangles.begin(), result.triangles.end());
    std::sort(result.edges.begin(), result.edges.end());
    result.edges.erase(std::unique(result.edges.begin(), result.edges.end()), result.edges.end());
    return result;
}

}  // namespace ostraka
