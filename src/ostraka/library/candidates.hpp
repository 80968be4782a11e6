// SPDX-License-Identifier: Apache-2.0
// The views and subparts of a model that might become entries, and the choice among them. Private.
#pragma once

#include <span>
#include <vector>

#include "ostraka/library/model_library.hpp"
#include "ostraka/views/model_views.hpp"

namespace ostraka {

/// @param views    of the model; clouds with normals, in the frame that it is looked at in.
/// @param surface  merge_surface() of them, in the same frame.
/// @param counts   filled in.
std::vector<Entry> choose_entries(std::span<const ModelView> views, const PointCloud& surface,
                                  const LibrarySettings& settings, BuildCounts& counts);

}  // namespace ostraka
