// SPDX-License-Identifier: Apache-2.0
// Protocols O and P as a page to look at.
#pragma once

#include "ostraka/evaluation/scenes.hpp"
#include "ostraka/report/page.hpp"

namespace ostraka {

struct ScenePageSettings {
    MatchSettings match;
    std::size_t failures = 6;  ///< scenes shown: scan, truth and answer
    int picture_width = 640;   ///< pixels
};

/// Figures with intervals, recall over occlusion and clutter, reliability of the confidence, who is
/// taken for whom, pose errors, seconds, and the worst failures as pictures.
/// @param set  loaded again for the scenes whose pictures are shown.
PageContent scene_page(std::span<const SceneRecord> records, const TestSet& set,
                       const ModelLibrary& library, const ScenePageSettings& settings = {});

}  // namespace ostraka
