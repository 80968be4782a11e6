// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/model_surface.hpp"

#include "ostraka/cloud/cell_grid.hpp"

namespace ostraka {
namespace {

// Points of one cell whose normals lie within 60 degrees of the first one's.
struct Side {
    Vec3f first_normal = Vec3f::Zero();
    Vec3d point_sum = Vec3d::Zero();
    Vec3d normal_sum = Vec3d::Zero();
    double count = 0.0;
};

PointCloud all_hits(std::span<const RenderedView> views) {
    PointCloud hits;
    for (const RenderedView& view : views) {
        const Pose T_model_camera = view.T_camera_world.inverse();
        const Mat3d R_model_camera = T_model_camera.linear();
        for (std::size_t i = 0; i < view.cloud.size(); ++i) {
            if (view.mesh[i] == kNoIndex) continue;
            hits.points.push_back(
                (T_model_camera * view.cloud.points[i].cast<double>()).cast<float>());
            hits.normals.push_back(
                Vec3d(R_model_camera * view.normals[i].cast<double>()).cast<float>());
        }
    }
    return hits;
}

}  // namespace

PointCloud merge_surface(std::span<const RenderedView> views, double spacing) {
    const PointCloud hits = all_hits(views);
    const CellGrid grid(hits.points, spacing);
    PointCloud surface;
    std::vector<Side> sides;
    for (std::size_t c = 0; c < grid.cell_count(); ++c) {
        sides.clear();
        for (const std::uint32_t i : grid.members(c)) {
            const Vec3f& normal = hits.normals[i];
            Side* side = nullptr;
            for (Side& known : sides) {
                if (known.first_normal.dot(normal) > 0.5F) side = &known;
            }
            if (side == nullptr) side = &sides.emplace_back(Side{.first_normal = normal});
            side->point_sum += hits.points[i].cast<double>();
            side->normal_sum += normal.cast<double>();
            side->count += 1.0;
        }
        for (const Side& side : sides) {
            surface.points.push_back(Vec3d(side.point_sum / side.count).cast<float>());
            surface.normals.push_back(side.normal_sum.normalized().cast<float>());
        }
    }
    return surface;
}

}  // namespace ostraka
