// SPDX-License-Identifier: Apache-2.0
// Local descriptors of a model: SHOT at points spread over its surface, described in the views that
// show them, so that what lies around is missing just as in a scan.
#pragma once

#include <span>

#include "ostraka/library/model_library.hpp"

namespace ostraka {

/// @param surface   merge_surface() of the model.
/// @param views     of the model, clouds with normals in the model frame.
/// @return up to 3 rows for each of the surface's keypoints: from a frontal, an oblique and a
/// middling
///         view of it.
Keypoints describe_keypoints(const PointCloud& surface, std::span<const ModelView> views,
                             const LibrarySettings& settings);

}  // namespace ostraka
