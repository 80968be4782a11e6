// SPDX-License-Identifier: Apache-2.0
// Results of single scenes as one line of JSON, and back: what a journal keeps.
#pragma once

#include <string>

#include "ostraka/evaluation/scenes.hpp"
#include "ostraka/evaluation/segments.hpp"

namespace ostraka {

std::string to_text(const SceneRecord& record);
/// @param library  whose models the record names. @throws InvalidInput if it isn't such a text.
SceneRecord scene_record_from_text(const std::string& text, const ModelLibrary& library);

/// Trials of one scene, a list for each library.
std::string to_text(const std::vector<std::vector<SegmentTrial>>& trials);
/// @throws InvalidInput if it isn't such a text.
std::vector<std::vector<SegmentTrial>> segment_trials_from_text(const std::string& text);

}  // namespace ostraka
