// SPDX-License-Identifier: Apache-2.0
// Models in, library out (method, section 2).
#pragma once

#include <span>

#include "ostraka/base/progress.hpp"
#include "ostraka/library/model_library.hpp"
#include "ostraka/library/model_source.hpp"

namespace ostraka {

/// Looks at every model from all sides, cuts the views, keeps the entries that matter and describes
/// them. The result depends on the models and settings only, not on their order or the threads.
/// @param models   at least one; distinct names; meshes in settings.unit.
/// @throws InvalidInput for no models, equal names or settings out of range; Interrupted.
ModelLibrary build_library(std::span<const ModelSource> models,
                           const LibrarySettings& settings = {}, const Progress& progress = {});

/// The sampling distance that build_library() uses where none is set: 1 % of the median diameter.
double default_sampling(std::span<const ModelSource> models);

}  // namespace ostraka
