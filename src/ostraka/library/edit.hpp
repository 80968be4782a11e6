// SPDX-License-Identifier: Apache-2.0
// Libraries from libraries: merged, extended, shortened. What depends on one model only is never
// worked out again, and the result is that of building all models at once. Bags of
// words (bags.hpp) depend on all models: where the (first) library has them, they are made anew.
#pragma once

#include <span>
#include <string>

#include "ostraka/base/progress.hpp"
#include "ostraka/library/model_library.hpp"
#include "ostraka/library/model_source.hpp"

namespace ostraka {

/// All models of several libraries of equal settings. The same library, byte by byte, as built at
/// once with these settings (`sampling` given, as it otherwise depends on all models).
/// @throws InvalidInput if there are none, settings differ (naming the first that does) or two
/// models
///         have one name.
ModelLibrary merge_libraries(std::vector<ModelLibrary> libraries);

/// The library with more models, built with its own settings; costs these models only.
/// @param models  meshes in the library's unit.
/// @throws InvalidInput for no models, or names that are taken.
ModelLibrary add_models(ModelLibrary library, std::span<const ModelSource> models,
                        const Progress& progress = {});

/// @throws InvalidInput if there is no model of that name, or it is the last one.
ModelLibrary remove_model(ModelLibrary library, const std::string& name);

/// @throws InvalidInput if there is no model of the old name, or the new one is empty or taken.
ModelLibrary rename_model(ModelLibrary library, const std::string& from, const std::string& to);

}  // namespace ostraka
