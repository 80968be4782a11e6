// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/surface_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kOversampling = 8;

// Index of the largest value; the first of equals.
std::size_t farthest(const std::vector<float>& squared_distances) {
    return static_cast<std::size_t>(
        std::max_element(squared_distances.begin(), squared_distances.end()) -
        squared_distances.begin());
}

}  // namespace

SurfaceSamples sample_uniformly(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
    std::vector<double> cumulative(mesh.triangles.size());
    double total = 0.0;
    for (std::size_t i = 0; i < cumulative.size(); ++i) {
        total += area_vector(mesh, mesh.triangles[i]).norm();
        cumulative[i] = total;
    }
    Random random(seed);
    SurfaceSamples samples;
    for (std::size_t i = 0; i < count; ++i) {
        const double target = random.uniform() * total;
        const auto it = std::upper_bound(cumulative.begin(), cumulative.end() - 1, target);
        const Triangle& triangle =
            mesh.triangles[static_cast<std::size_t>(it - cumulative.begin())];
        const double r = std::sqrt(random.uniform());
        const double s = random.uniform();
        const Vec3d a = mesh.vertices[triangle[0]].cast<double>();
        const Vec3d b = mesh.vertices[triangle[1]].cast<double>();
        const Vec3d c = mesh.vertices[triangle[2]].cast<double>();
        samples.points.push_back(
            Vec3d((1.0 - r) * a + r * (1.0 - s) * b + r * s * c).cast<float>());
        samples.normals.push_back(area_vector(mesh, triangle).normalized().cast<float>());
    }
    return samples;
}

SurfaceSamples sample_evenly(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
    const SurfaceSamples pool = sample_uniformly(mesh, kOversampling * count, seed);
    std::vector<float> squared(pool.points.size(), std::numeric_limits<float>::max());
    SurfaceSamples samples;
    std::size_t next = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const Vec3f chosen = pool.points[next];
        samples.points.push_back(chosen);
        samples.normals.push_back(pool.normals[next]);
        for (std::size_t i = 0; i < squared.size(); ++i) {
            squared[i] = std::min(squared[i], (pool.points[i] - chosen).squaredNorm());
        }
        next = farthest(squared);
    }
    return samples;
}

}  // namespace ostraka
