// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/surface_roughness.hpp"

#include <cmath>

#include "ostraka/cloud/kdtree.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kPoints = 4000;  // that are looked at
constexpr float kCrease = 0.8F;        // cosine between normals beyond which there is an edge

}  // namespace

double surface_roughness(const PointCloud& surface) {
    const KdTree tree(surface.points);
    std::vector<Neighbor> next;
    double squares = 0.0;
    std::size_t count = 0;
    const std::size_t stride = 1 + surface.size() / kPoints;
    for (std::size_t i = 0; i < surface.size(); i += stride) {
        tree.nearest(surface.points[i], 2, next);
        const std::uint32_t beside = next.back().index;
        const Vec3f& normal = surface.normals[i];
        if (normal.dot(surface.normals[beside]) < kCrease) continue;
        const float off = normal.dot(surface.points[beside] - surface.points[i]);
        squares += double{off} * double{off};
        ++count;
    }
    return count == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(count));
}

}  // namespace ostraka
