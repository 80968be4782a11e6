// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/normals.hpp"

#include <array>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/cell_grid.hpp"
#include "ostraka/cloud/plane_fit.hpp"

namespace ostraka {
namespace {

// Offsets are short and many: single precision sums of ten products each lose nothing that matters.
Vec3f fit_normal_within(const Vec3f& query, std::span<const Vec3f> candidates,
                        float squared_radius) {
    std::array<float, 9> sums{};
    float count = 0.0F;
    for (const Vec3f& candidate : candidates) {
        const float x = candidate.x() - query.x();
        const float y = candidate.y() - query.y();
        const float z = candidate.z() - query.z();
        if (!(x * x + y * y + z * z < squared_radius)) continue;
        const std::array<float, 9> terms = {x, y, z, x * x, x * y, x * z, y * y, y * z, z * z};
        for (std::size_t k = 0; k < 9; ++k) sums[k] += terms[k];
        count += 1.0F;
    }
    Moments moments;
    moments.first = Vec3d(double{sums[0]}, double{sums[1]}, double{sums[2]});
    moments.second << double{sums[3]}, double{sums[4]}, double{sums[5]}, double{sums[4]},
        double{sums[6]}, double{sums[7]}, double{sums[5]}, double{sums[7]}, double{sums[8]};
    moments.count = double{count};
    return fit_normal(moments, kLineRatioSingle);
}

Vec3f toward(const Vec3f& normal, const Vec3f& from, const Vec3f& viewpoint) {
    return normal.dot(viewpoint - from) < 0.0F ? Vec3f(-normal) : normal;
}

}  // namespace

std::vector<Vec3f> estimate_normals(const PointCloud& cloud, const NormalSettings& settings) {
    if (settings.neighbors < 3) throw InvalidInput("normals: neighbors must be at least 3");
    std::vector<Vec3f> normals(cloud.size());
    visit_nearest_moments(
        cloud.points, static_cast<std::size_t>(settings.neighbors), [&](const MomentBatch& batch) {
            std::array<Vec3f, MomentBatch::kCapacity> fitted;
            fit_normals(batch, fitted);
            for (std::size_t lane = 0; lane < batch.count; ++lane) {
                const std::uint32_t i = batch.index[lane];
                normals[i] = toward(fitted[lane], cloud.points[i], cloud.viewpoint);
            }
        });
    return normals;
}

std::vector<Vec3f> estimate_normals_within(const PointCloud& cloud, double radius) {
    const CellGrid grid(cloud.points, radius);
    const auto squared_radius = static_cast<float>(radius * radius);
    std::vector<Vec3f> normals(cloud.size());
    parallel_for(
        grid.cell_count(),
        [&](std::size_t c) {
            thread_local std::vector<std::uint32_t> cells;
            thread_local std::vector<Vec3f> candidates;
            grid.neighborhood(c, cells);
            candidates.clear();
            for (const std::uint32_t cell : cells) {
                for (const std::uint32_t i : grid.members(cell)) {
                    candidates.push_back(cloud.points[i]);
                }
            }
            for (const std::uint32_t i : grid.members(c)) {
                const Vec3f& point = cloud.points[i];
                normals[i] = toward(fit_normal_within(point, candidates, squared_radius), point,
                                    cloud.viewpoint);
            }
        },
        64);
    return normals;
}

}  // namespace ostraka
