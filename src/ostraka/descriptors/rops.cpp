// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/rops.hpp"

#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/neighborhoods.hpp"
#include "ostraka/descriptors/rops_frame.hpp"
#include "ostraka/descriptors/rops_statistics.hpp"
#include "ostraka/descriptors/support.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kChunk = 16;  // keypoints that share scratch memory

void require_triangles(std::span<const IndexTriangle> triangles, std::size_t points) {
    for (const IndexTriangle& triangle : triangles) {
        if (triangle[0] < points && triangle[1] < points && triangle[2] < points) continue;
        throw InvalidInput(fmt::format("rops: triangle {} {} {} of a cloud of {} points",
                                       triangle[0], triangle[1], triangle[2], points));
    }
}

}  // namespace

LocalDescriptors describe_rops(const PointCloud& cloud, std::span<const IndexTriangle> triangles,
                               std::span<const Vec3f> keypoints, const RopsSettings& settings) {
    require_search(cloud, keypoints, settings.radius, "rops");
    require_triangles(triangles, cloud.size());
    LocalDescriptors result;
    result.rows.assign(keypoints.size() * kRopsLength, 0.0F);
    result.frames.assign(keypoints.size(), no_frame());
    if (cloud.empty() || keypoints.empty()) return result;
    const RopsSurface surface(cloud.points, triangles, settings.radius);
    const Neighborhoods neighborhoods(cloud, settings.radius, false);
    const std::size_t chunks = (keypoints.size() + kChunk - 1) / kChunk;
    parallel_for(chunks, [&](std::size_t chunk) {
        Support support;
        RopsScratch scratch;
        const std::size_t end = std::min(keypoints.size(), (chunk + 1) * kChunk);
        for (std::size_t k = chunk * kChunk; k < end; ++k) {
            result.frames[k] = surface.local_frame(keypoints[k]);
            if (!result.frames[k].allFinite()) continue;
            neighborhoods.find(keypoints[k], support);
            const std::span<float> row(result.rows.data() + k * kRopsLength, kRopsLength);
            rops_statistics(support, result.frames[k], scratch, row);
        }
    });
    return result;
}

LocalDescriptors describe_rops(const PointCloud& cloud, const KdTree& tree,
                               std::span<const IndexTriangle> triangles,
                               std::span<const Vec3f> keypoints, const RopsSettings& settings) {
    require_support(cloud, tree, keypoints, settings.radius, "rops");
    return describe_rops(cloud, triangles, keypoints, settings);
}

std::vector<float> describe_global_rops(const PointCloud& cloud,
                                        const GlobalRopsSettings& settings) {
    require_points(cloud, "rops");
    require_normals(cloud, "rops");
    return describe_global_rops(cloud, triangulate(cloud, settings.triangulation));
}

std::vector<float> describe_global_rops(const PointCloud& cloud,
                                        std::span<const IndexTriangle> triangles) {
    require_points(cloud, "rops");
    require_triangles(triangles, cloud.size());
    const WholeSupport whole = whole_support(cloud.points);
    std::vector<float> row(kRopsLength, 0.0F);
    const Mat3f frame = whole_frame(cloud.points, triangles, whole.center, whole.radius);
    if (!frame.allFinite()) return row;
    Support support;
    gather(
        cloud, whole.center, cloud.size(), false, [](std::size_t i) { return i; }, support);
    RopsScratch scratch;
    rops_statistics(support, frame, scratch, row);
    return row;
}

}  // namespace ostraka
