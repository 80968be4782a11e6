// SPDX-License-Identifier: Apache-2.0
// The part of a model that can be seen from outside, merged from its views. A CAD model's inner
// faces, and the way its triangles are wound, don't matter.
#pragma once

#include <span>

#include "ostraka/views/render.hpp"

namespace ostraka {

/// Merges the hits of all views: the mean of those in each cubic cell that face the same way.
/// @param views    of one model; T_camera_world is T_camera_model.
/// @param spacing  side of a cell, in the model's unit.
/// @return model frame, with outward normals; viewpoint unused. Both sides of a wall thinner than a
///         cell are kept.
PointCloud merge_surface(std::span<const RenderedView> views, double spacing);

}  // namespace ostraka
