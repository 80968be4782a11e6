// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/surface_nets.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

using Vec3i = Eigen::Vector3i;

// Between two neighboring corners on different sides of the surface.
struct Crossing {
    Vec3i corner;  // the lower one
    int axis;
    bool outward;  // the distance grows along the axis
};

struct NetBlock {
    std::vector<Vec3f> vertices;
    std::vector<std::uint32_t> vertex_of;  // of each cell, within the block, or kNoIndex; empty if
                                           // there are no vertices
    std::vector<Crossing> crossings;       // at corners of the block's cells, lowest included
    std::uint32_t first_vertex = 0;        // of all vertices
};

std::size_t corner_index(const Vec3i& corner) {
    return static_cast<std::size_t>((corner.z() * kCorners + corner.y()) * kCorners + corner.x());
}

std::size_t cell_index(const Vec3i& cell) {
    return static_cast<std::size_t>((cell.z() * kBlockSide + cell.y()) * kBlockSide + cell.x());
}

template <class Visit>
void for_cells(const Visit& visit) {
    for (int z = 0; z < kBlockSide; ++z) {
        for (int y = 0; y < kBlockSide; ++y) {
            for (int x = 0; x < kBlockSide; ++x) visit(Vec3i(x, y, z));
        }
    }
}

// The mean of the crossings of the cell's edges; false if there are none or a corner is unknown.
bool net_vertex(const std::vector<float>& distances, const Vec3i& cell, Vec3f& vertex) {
    std::array<float, 8> at{};
    unsigned inside = 0;
    for (unsigned i = 0; i < 8; ++i) {
        const Vec3i step(static_cast<int>(i & 1U), static_cast<int>(i >> 1U & 1U),
                         static_cast<int>(i >> 2U));
        at[i] = distances[corner_index(cell + step)];
        if (std::isnan(at[i])) return false;
        inside += at[i] < 0.0F ? 1 : 0;
    }
    if (inside == 0 || inside == 8) return false;
    Vec3f sum = Vec3f::Zero();
    float count = 0.0F;
    for (unsigned i = 0; i < 8; ++i) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            const unsigned j = i | 1U << axis;
            if (j == i || (at[i] < 0.0F) == (at[j] < 0.0F)) continue;
            Vec3f crossing(static_cast<float>(i & 1U), static_cast<float>(i >> 1U & 1U),
                           static_cast<float>(i >> 2U));
            crossing[axis] = at[i] / (at[i] - at[j]);
            sum += crossing;
            count += 1.0F;
        }
    }
    vertex = cell.cast<float>() + sum / count;
    return true;
}

// Onto the zero set; false where the surface has no points around it.
bool settle(Vec3f& vertex, std::span<const Splat> near, double open_edge) {
    constexpr int kSteps = 3;
    constexpr float kLongStep = 0.5F;  // cells: a vertex stays about in its cell
    Vec3f facing = Vec3f::Zero();
    for (int step = 0; step <= kSteps; ++step) {
        const FieldValue value = field_at(vertex, near, facing);
        if (!(value.weight > 0.0F)) return false;
        if (step == kSteps) {
            return value.aside.norm() <= static_cast<float>(open_edge) * value.radius;
        }
        const float length = value.normal.norm();
        if (!(length > 0.1F)) continue;  // opposite surfaces meet
        const float move = std::clamp(value.distance / length, -kLongStep, kLongStep);
        facing = value.normal / length;
        vertex -= move * facing;
    }
    return false;
}

void find_crossings(const std::vector<float>& distances, const Vec3i& origin, const Vec3i& corner,
                    std::vector<Crossing>& crossings) {
    const float from = distances[corner_index(corner)];
    for (int axis = 0; axis < 3; ++axis) {
        const float to = distances[corner_index(corner + Vec3i::Unit(axis))];
        if (std::isnan(from) || std::isnan(to) || (from < 0.0F) == (to < 0.0F)) continue;
        crossings.push_back({origin + corner, axis, from < 0.0F});
    }
}

NetBlock net_of_block(const DistanceBlocks& blocks, std::size_t block, double open_edge) {
    thread_local std::vector<Splat> near;
    thread_local std::vector<float> distances;
    NetBlock net;
    blocks.gather(block, near);
    if (near.empty()) return net;
    const Vec3i origin = blocks.origin(block);
    fill_distances(origin, near, distances);
    std::vector<std::uint32_t> vertex_of(std::size_t{kBlockSide} * kBlockSide * kBlockSide,
                                         kNoIndex);
    for_cells([&](const Vec3i& cell) {
        find_crossings(distances, origin, cell, net.crossings);
        Vec3f vertex;
        if (!net_vertex(distances, cell, vertex)) return;
        vertex += origin.cast<float>();
        if (!settle(vertex, near, open_edge)) return;
        vertex_of[cell_index(cell)] = static_cast<std::uint32_t>(net.vertices.size());
        net.vertices.push_back(vertex);
    });
    if (!net.vertices.empty()) net.vertex_of = std::move(vertex_of);
    return net;
}

std::uint32_t vertex_in(const DistanceBlocks& blocks, std::span<const NetBlock> nets,
                        std::size_t hint, const Vec3i& cell) {
    Vec3i local = cell - blocks.origin(hint);
    std::size_t block = hint;
    if (local.minCoeff() < 0) {  // crossings look back only
        block = blocks.find(cell);
        if (block == kNoIndex) return kNoIndex;
        local = cell - blocks.origin(block);
    }
    const NetBlock& net = nets[block];
    if (net.vertex_of.empty()) return kNoIndex;
    const std::uint32_t vertex = net.vertex_of[cell_index(local)];
    return vertex == kNoIndex ? kNoIndex : net.first_vertex + vertex;
}

// The four cells around the edge make a quadrangle, cut along its shorter diagonal; three of them,
// at the end of the surface, a triangle.
void add_faces(const DistanceBlocks& blocks, std::span<const NetBlock> nets, std::size_t block,
               const Crossing& crossing, TriangleMesh& mesh) {
    const Vec3i right = Vec3i::Unit((crossing.axis + 1) % 3);
    const Vec3i up = Vec3i::Unit((crossing.axis + 2) % 3);
    const std::array<Vec3i, 4> cells = {crossing.corner - right - up, crossing.corner - up,
                                        crossing.corner, crossing.corner - right};
    std::array<std::uint32_t, 4> quad{};
    std::size_t count = 0;
    for (const Vec3i& cell : cells) {
        const std::uint32_t vertex = vertex_in(blocks, nets, block, cell);
        if (vertex != kNoIndex) quad[count++] = vertex;
    }
    if (count < 3) return;
    if (!crossing.outward) std::reverse(quad.begin(), quad.begin() + static_cast<int>(count));
    const auto length = [&](std::size_t i, std::size_t j) {
        return (mesh.vertices[quad[i]] - mesh.vertices[quad[j]]).squaredNorm();
    };
    if (count == 3) {
        mesh.triangles.push_back({quad[0], quad[1], quad[2]});
    } else if (length(0, 2) <= length(1, 3)) {
        mesh.triangles.push_back({quad[0], quad[1], quad[2]});
        mesh.triangles.push_back({quad[0], quad[2], quad[3]});
    } else {
        mesh.triangles.push_back({quad[1], quad[2], quad[3]});
        mesh.triangles.push_back({quad[1], quad[3], quad[0]});
    }
}

}  // namespace

TriangleMesh surface_nets(std::span<const Splat> splats, double open_edge) {
    const DistanceBlocks blocks(splats);
    std::vector<NetBlock> nets(blocks.size());
    parallel_for(blocks.size(),
                 [&](std::size_t b) { nets[b] = net_of_block(blocks, b, open_edge); });
    TriangleMesh mesh;
    for (NetBlock& net : nets) {
        net.first_vertex = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.insert(mesh.vertices.end(), net.vertices.begin(), net.vertices.end());
    }
    for (std::size_t b = 0; b < nets.size(); ++b) {
        for (const Crossing& crossing : nets[b].crossings) {
            add_faces(blocks, nets, b, crossing, mesh);
        }
    }
    return mesh;
}

}  // namespace ostraka
