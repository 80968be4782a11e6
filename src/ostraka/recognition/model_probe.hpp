// SPDX-License-Identifier: Apache-2.0
// What recognition keeps ready of a model: to refine, score and verify poses of it quickly.
#pragma once

#include <array>
#include <bitset>

#include "ostraka/library/model_library.hpp"
#include "ostraka/recognition/face_matching.hpp"
#include "ostraka/registration/surface_field.hpp"
#include "ostraka/views/ray_scene.hpp"

namespace ostraka {

inline constexpr std::size_t kProbeSamples = 512;
inline constexpr std::size_t kProbeViews = 162;

class ModelProbe {
  public:
    /// @param model     of the library; must outlive the probe.
    /// @param sampling  the library's.
    ModelProbe(const Model& model, double sampling);

    const Model& model() const { return *model_; }
    const SurfaceField& field() const { return field_; }
    const RayScene& rays() const { return rays_; }
    /// Evenly spread points of the surface, model frame.
    const std::vector<Vec3f>& samples() const { return samples_; }
    const std::vector<Vec3f>& normals() const { return normals_; }
    /// Its flat faces, if much of its surface is flat; else none. Model frame.
    const std::vector<FlatFace>& faces() const { return faces_; }
    /// How rough it is at the sampling distance: RMS distance of a point of the surface from the
    /// tangent plane of the point next to it, where it isn't creased.
    double detail() const { return detail_; }
    /// near_symmetries().
    const std::vector<Pose>& turns() const { return turns_; }
    /// Which samples the model itself doesn't hide from a sensor at `viewpoint` (model frame).
    const std::bitset<kProbeSamples>& visible_from(const Vec3f& viewpoint) const;

  private:
    const Model* model_;
    SurfaceField field_;
    RayScene rays_;
    std::vector<Vec3f> samples_;
    std::vector<Vec3f> normals_;
    std::vector<FlatFace> faces_;
    double detail_ = 0.0;
    std::vector<Pose> turns_;
    static constexpr std::size_t kPaddedViews = (kProbeViews + 7) / 8 * 8;
    // kProbeViews, model frame; x, y and z side by side, as the nearest is sought for each pose.
    // Padded by zeros, which are never the nearest.
    std::array<std::array<float, kPaddedViews>, 3> directions_{};
    std::vector<std::bitset<kProbeSamples>> visible_;  // one per direction
};

}  // namespace ostraka
