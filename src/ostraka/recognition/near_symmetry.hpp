// SPDX-License-Identifier: Apache-2.0
// Turns that map a model nearly onto itself: a shaft but for its keyway, a block but for one hole.
// Registration can't get from one to the other, and hypotheses may miss the right one.
#pragma once

#include <span>
#include <vector>

#include "ostraka/mesh/shape.hpp"
#include "ostraka/mesh/symmetry.hpp"
#include "ostraka/registration/surface_field.hpp"

namespace ostraka {

/// Turns about the principal directions of the surface and the direction that does best, those by
/// steps about one of them and half turns across, after which three quarters of the surface lie on
/// it again.
/// @param field    of the model's surface; model frame.
/// @param points, normals  evenly spread on the surface.
/// @param exact    the model's symmetries: of turns that are the same but for one of these, only
///                 one is given, and none for the identity.
/// @param sampling  of the surface.
/// @return T_model_model.
std::vector<Pose> near_symmetries(const SurfaceField& field, std::span<const Vec3f> points,
                                  std::span<const Vec3f> normals, const MeshShape& shape,
                                  const Symmetry& exact, double sampling);

}  // namespace ostraka
