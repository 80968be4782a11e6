// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/model_probe.hpp"

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/farthest_points.hpp"
#include "ostraka/recognition/near_symmetry.hpp"
#include "ostraka/recognition/surface_roughness.hpp"
#include "ostraka/views/viewpoints.hpp"

namespace ostraka {
namespace {

constexpr double kFieldCell = 1.5;     // sampling distances
constexpr double kFieldMargin = 0.1;   // of the diameter: how far off a pose may be
constexpr double kViewDistance = 3.0;  // diameters
constexpr double kHitTolerance = 1.0;  // sampling distances
constexpr double kFlatShare = 0.3;     // of the surface on faces, from which a part is flat or boxy

std::vector<FlatFace> faces_of(const PointCloud& surface, double sampling) {
    std::vector<FlatFace> faces = flat_faces(surface, sampling);
    std::size_t points = 0;
    for (const FlatFace& face : faces) points += face.indices.size();
    if (static_cast<double>(points) < kFlatShare * static_cast<double>(surface.size())) return {};
    return faces;
}

}  // namespace

ModelProbe::ModelProbe(const Model& model, double sampling)
    : model_(&model),
      field_(model.surface, kFieldCell * sampling, kFieldMargin * model.shape.diameter),
      rays_({model.mesh}),
      faces_(faces_of(model.surface, sampling)),
      detail_(surface_roughness(model.surface)) {
    for (const std::uint32_t i : farthest_points(model.surface.points, kProbeSamples)) {
        samples_.push_back(model.surface.points[i]);
        normals_.push_back(model.surface.normals[i]);
    }
    turns_ = near_symmetries(field_, samples_, normals_, model.shape, model.symmetry, sampling);
    for (const Vec3d& direction : viewpoints(static_cast<int>(kProbeViews))) {
        directions_.push_back(direction.cast<float>());
    }
    visible_.resize(kProbeViews);
    parallel_for(kProbeViews, [&](std::size_t v) {
        const Vec3d eye = model.shape.center +
                          kViewDistance * model.shape.diameter * directions_[v].cast<double>();
        std::vector<Vec3d> rays;
        for (const Vec3f& sample : samples_) rays.push_back(sample.cast<double>() - eye);
        const std::vector<RayHit> hits = rays_.cast(eye, rays);
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const double short_of = (1.0 - hits[i].distance) * rays[i].norm();
            const bool facing = normals_[i].cast<double>().dot(rays[i]) < 0.0;
            visible_[v][i] = facing && (!hits[i].hit() || short_of < kHitTolerance * sampling);
        }
    });
}

const std::bitset<kProbeSamples>& ModelProbe::visible_from(const Vec3f& viewpoint) const {
    const Vec3f direction = viewpoint - model_->shape.center.cast<float>();
    std::size_t best = 0;
    for (std::size_t v = 1; v < kProbeViews; ++v) {
        if (directions_[v].dot(direction) > directions_[best].dot(direction)) best = v;
    }
    return visible_[best];
}

}  // namespace ostraka
