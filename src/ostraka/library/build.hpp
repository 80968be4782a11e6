// SPDX-License-Identifier: Apache-2.0
// Models in, library out (method, section 2).
#pragma once

#include <span>

#include "ostraka/base/progress.hpp"
#include "ostraka/library/model_record.hpp"
#include "ostraka/library/model_source.hpp"

namespace ostraka {

/// Looks at every model from all sides, cuts the views, keeps the entries that matter and describes
/// them. The result depends on the models and settings only, not on their order or the threads.
/// @param models   at least one; distinct names; meshes in settings.unit.
/// @throws InvalidInput for no models, equal names or settings out of range; Interrupted.
ModelLibrary build_library(std::span<const ModelSource> models,
                           const LibrarySettings& settings = {}, const Progress& progress = {});

using RecordSink = std::function<void(ModelRecord)>;

/// The same as an assembly line: a few models are in memory at a time, whatever their number.
/// @param settings  complete_settings().
/// @param sink      gets the finished models, in the order of `models`, one at a time.
/// @throws InvalidInput, FileError, FormatError for a model that can't be used; Interrupted.
void build_records(std::span<const ModelInput> models, const LibrarySettings& settings,
                   const RecordSink& sink, const Progress& progress = {});

/// The sampling distance that is used where none is set: 1 % of the median diameter.
double default_sampling(std::span<const ModelInput> models);

/// Fills in the settings that are derived from others.
/// @param settings  sampling set. @throws InvalidInput if one is out of range.
LibrarySettings complete_settings(LibrarySettings settings);

/// @throws InvalidInput, naming the name, if two models have one name.
void require_distinct_names(std::span<const ModelInput> models);

}  // namespace ostraka
