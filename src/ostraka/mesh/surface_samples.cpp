// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/surface_samples.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/random.hpp"
#include "ostraka/cloud/farthest_points.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kOversampling = 8;

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
    SurfaceSamples samples;
    for (const std::uint32_t i : farthest_points(pool.points, count)) {
        samples.points.push_back(pool.points[i]);
        samples.normals.push_back(pool.normals[i]);
    }
    return samples;
}

}  // namespace ostraka
