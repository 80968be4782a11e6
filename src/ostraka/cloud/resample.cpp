// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/resample.hpp"

#include <cmath>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/cell_grid.hpp"
#include "ostraka/cloud/kdtree.hpp"

namespace ostraka {
namespace {

Color mean_color(const PointCloud& cloud, std::span<const std::uint32_t> members) {
    std::array<std::uint64_t, 3> sum{};
    for (const std::uint32_t i : members) {
        for (std::size_t c = 0; c < 3; ++c) sum[c] += cloud.colors[i][c];
    }
    Color color;
    for (std::size_t c = 0; c < 3; ++c)
        color[c] = static_cast<std::uint8_t>(sum[c] / members.size());
    return color;
}

Vec3d mean_of(const std::vector<Vec3f>& vectors, std::span<const std::uint32_t> members) {
    Vec3d sum = Vec3d::Zero();
    for (const std::uint32_t i : members) sum += vectors[i].cast<double>();
    return sum / static_cast<double>(members.size());
}

}  // namespace

PointCloud resample(const PointCloud& cloud, double spacing) {
    const PointCloud valid = remove_invalid(cloud);
    const CellGrid grid(valid.points, spacing);
    PointCloud result;
    result.viewpoint = cloud.viewpoint;
    result.points.reserve(grid.cell_count());
    for (std::size_t c = 0; c < grid.cell_count(); ++c) {
        const std::span<const std::uint32_t> members = grid.members(c);
        if (!valid.normals.empty()) {
            const Vec3d normal = mean_of(valid.normals, members);
            if (!(normal.norm() > 1e-3)) continue;
            result.normals.push_back(normal.normalized().cast<float>());
        }
        result.points.push_back(mean_of(valid.points, members).cast<float>());
        if (!valid.colors.empty()) result.colors.push_back(mean_color(valid, members));
    }
    return result;
}

double mesh_resolution(std::span<const Vec3f> points) {
    if (points.size() < 2) return 0.0;
    const KdTree tree(points);
    std::vector<float> distances(points.size());
    parallel_for(
        points.size(),
        [&](std::size_t i) {
            thread_local std::vector<Neighbor> nearest;
            tree.nearest(points[i], 2, nearest);
            distances[i] = std::sqrt(nearest[1].squared_distance);
        },
        512);
    double sum = 0.0;
    for (const float distance : distances) sum += double{distance};
    return sum / static_cast<double>(points.size());
}

}  // namespace ostraka
