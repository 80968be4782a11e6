// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/rolling_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/vector_clones.hpp"
#include "ostraka/views/viewpoints.hpp"

namespace ostraka {
namespace {

constexpr int kDirections = 642;  // as viewpoints() takes it
constexpr double kMaxGap = 0.01;  // of the surface: openings that a closed mesh may have

constexpr std::size_t kBlock = 512;  // points between two looks at the greatest so far

// The greatest of d . p over one block.
OSTRAKA_VECTOR_CLONES float block_extreme(const RollingShape& shape, std::size_t begin,
                                          const float* direction) {
    const float* x = shape.vertices[0].data() + begin;
    const float* y = shape.vertices[1].data() + begin;
    const float* z = shape.vertices[2].data() + begin;
    Float8 greatest = Float8{} - std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < kBlock; i += kVectorLanes) {
        Float8 px;
        Float8 py;
        Float8 pz;
        load8(x + i, px);
        load8(y + i, py);
        load8(z + i, pz);
        const Float8 dot = direction[0] * px + direction[1] * py + direction[2] * pz;
        greatest = dot > greatest ? dot : greatest;
    }
    float result = greatest[0];
    for (std::size_t lane = 1; lane < kVectorLanes; ++lane) {
        result = std::max(result, greatest[lane]);
    }
    return result;
}

// The vertices from the center of mass, filled up to whole blocks with copies of the first, and the
// points. False if the center is not inside their hull.
bool fill(const TriangleMesh& mesh, RollingShape& shape) {
    std::vector<bool> used(mesh.vertices.size(), false);
    for (const Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t v : triangle) used[v] = true;
    }
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float>& column = shape.vertices[static_cast<std::size_t>(axis)];
        column.clear();
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
            if (!used[v]) continue;
            const double offset = double{mesh.vertices[v][axis]} - shape.center_of_mass[axis];
            column.push_back(static_cast<float>(offset));
        }
        column.resize((column.size() + kBlock - 1) / kBlock * kBlock, column.front());
    }
    bool around = true;
    shape.points.clear();
    for (const Vec3d& direction : viewpoints(kDirections)) {
        shape.points.push_back(extreme_vertex(shape, direction));
        around = around && shape.points.back().dot(direction) > 0.0;
    }
    std::sort(shape.points.begin(), shape.points.end(), [](const Vec3d& a, const Vec3d& b) {
        return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    });
    shape.points.erase(std::unique(shape.points.begin(), shape.points.end()), shape.points.end());
    double squared = 0.0;
    for (std::size_t i = 0; i < shape.vertices[0].size(); ++i) {
        const Vec3f v(shape.vertices[0][i], shape.vertices[1][i], shape.vertices[2][i]);
        squared = std::max(squared, v.cast<double>().squaredNorm());
    }
    shape.radius = std::sqrt(squared);
    return around;
}

struct Centroids {
    Vec3d surface = Vec3d::Zero();
    Vec3d volume = Vec3d::Zero();
    bool closed = false;
};

Centroids centroids(const TriangleMesh& mesh) {
    const Vec3d origin = mesh.vertices[mesh.triangles[0][0]].cast<double>();
    double area = 0.0;
    Vec3d area_sum = Vec3d::Zero();
    Vec3d area_vectors = Vec3d::Zero();
    for (const Triangle& triangle : mesh.triangles) {
        const Vec3d vector = 0.5 * area_vector(mesh, triangle);
        Vec3d middle = -origin;
        for (const std::uint32_t v : triangle) middle += mesh.vertices[v].cast<double>() / 3.0;
        area += vector.norm();
        area_sum += vector.norm() * middle;
        area_vectors += vector;
    }
    Centroids result;
    result.surface = origin + area_sum / area;
    // Tetrahedra from the surface's centroid, where small openings matter least.
    double volume = 0.0;
    Vec3d volume_sum = Vec3d::Zero();
    for (const Triangle& triangle : mesh.triangles) {
        const Vec3d a = mesh.vertices[triangle[0]].cast<double>() - result.surface;
        const Vec3d b = mesh.vertices[triangle[1]].cast<double>() - result.surface;
        const Vec3d c = mesh.vertices[triangle[2]].cast<double>() - result.surface;
        const double tetrahedron = a.dot(b.cross(c)) / 6.0;
        volume += tetrahedron;
        volume_sum += tetrahedron / 4.0 * (a + b + c);
    }
    // The area vectors of a closed surface cancel. Inward or outward does not matter.
    result.closed =
        area_vectors.norm() < kMaxGap * area && std::abs(volume) > 1e-6 * std::pow(area, 1.5);
    if (result.closed) result.volume = result.surface + volume_sum / volume;
    return result;
}

}  // namespace

Vec3d extreme_vertex(const RollingShape& shape, const Vec3d& direction) {
    const Vec3f d = direction.cast<float>();
    const auto& [x, y, z] = shape.vertices;
    float greatest = -std::numeric_limits<float>::infinity();
    std::size_t block = 0;
    for (std::size_t begin = 0; begin < x.size(); begin += kBlock) {
        const float extreme = block_extreme(shape, begin, d.data());
        if (extreme > greatest) {
            greatest = extreme;
            block = begin;
        }
    }
    const auto dot = [&](std::size_t i) { return d[0] * x[i] + d[1] * y[i] + d[2] * z[i]; };
    std::size_t best = block;
    for (std::size_t i = block + 1; i < block + kBlock; ++i) {
        if (dot(i) > dot(best)) best = i;
    }
    return {double{x[best]}, double{y[best]}, double{z[best]}};
}

RollingShape rolling_shape(const TriangleMesh& mesh) {
    const Centroids centers = centroids(mesh);
    RollingShape shape{.center_of_mass = centers.closed ? centers.volume : centers.surface};
    if (!fill(mesh, shape) && centers.closed) {
        // With parts inside out, the volume's center may be anywhere.
        shape.center_of_mass = centers.surface;
        fill(mesh, shape);
    }
    return shape;
}

}  // namespace ostraka
