// SPDX-License-Identifier: Apache-2.0
// One model, looked at from all sides, cut, selected from and described. Private.
#pragma once

#include <functional>

#include "ostraka/library/model_record.hpp"
#include "ostraka/library/model_source.hpp"

namespace ostraka {

/// @param settings  complete_settings().
/// @param step      called with the number of views that are done, settings.views.count in all;
///                  from any thread.
/// @throws InvalidInput if nothing of the model can be seen.
ModelRecord build_record(const ModelSource& source, const LibrarySettings& settings,
                         const std::function<void(std::size_t)>& step);

}  // namespace ostraka
