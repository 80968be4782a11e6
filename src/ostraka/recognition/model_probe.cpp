// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/model_probe.hpp"

#include <algorithm>
#include <array>

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
    const std::vector<Vec3d> directions = viewpoints(static_cast<int>(kProbeViews));
    for (std::size_t v = 0; v < kProbeViews; ++v) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            directions_[axis][v] =
                static_cast<float>(directions[v][static_cast<Eigen::Index>(axis)]);
        }
    }
    visible_.resize(kProbeViews);
    parallel_for(kProbeViews, [&](std::size_t v) {
        const Vec3d eye = model.shape.center + kViewDistance * model.shape.diameter *
                                                   directions[v].cast<float>().cast<double>();
        std::vector<std::size_t> facing;
        std::vector<Vec3d> in_front;  // of them, a little nearer to the eye
        for (std::size_t i = 0; i < samples_.size(); ++i) {
            const Vec3d at = samples_[i].cast<double>();
            if (!(normals_[i].cast<double>().dot(at - eye) < 0.0)) continue;
            facing.push_back(i);
            in_front.push_back(at + kHitTolerance * sampling * (eye - at).normalized());
        }
        const std::vector<char> hidden = rays_.hidden(eye, in_front);
        for (std::size_t k = 0; k < facing.size(); ++k) visible_[v][facing[k]] = hidden[k] == 0;
    });
}

const std::bitset<kProbeSamples>& ModelProbe::visible_from(const Vec3f& viewpoint) const {
    const Vec3f direction = viewpoint - model_->shape.center.cast<float>();
    std::array<float, kPaddedViews> cosines;
    for (std::size_t v = 0; v < kPaddedViews; ++v) {
        cosines[v] = directions_[0][v] * direction.x() + directions_[1][v] * direction.y() +
                     directions_[2][v] * direction.z();
    }
    // Lane by lane, as compilers vectorize no search for a maximum.
    std::array<float, 8> most{};
    for (std::size_t v = 0; v < kPaddedViews; v += most.size()) {
        for (std::size_t lane = 0; lane < most.size(); ++lane) {
            most[lane] = std::max(most[lane], cosines[v + lane]);
        }
    }
    const float highest = *std::max_element(most.begin(), most.end());
    const auto best = std::find(cosines.begin(), cosines.end(), highest);
    // A direction that isn't finite has none.
    const auto index = static_cast<std::size_t>(best - cosines.begin());
    return visible_[std::min(index, kProbeViews - 1)];
}

}  // namespace ostraka
