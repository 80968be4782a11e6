// SPDX-License-Identifier: Apache-2.0
// Pictures of what the scan says of each piece of a placed model.
#pragma once

#include "ostraka/io/png_file.hpp"
#include "ostraka/recognition/explanation.hpp"

namespace ostraka {

struct VerdictPictureSettings {
    int width = 460;   ///< pixels
    int height = 300;  ///< pixels
};

struct VerdictPicture {
    Image scan;      ///< the scan around the placed model, in gray
    Image verdicts;  ///< the same, each cell of the silhouette in the color of its verdict
};

/// Colors that people with any color vision can tell apart on gray.
Color verdict_color(CellVerdict verdict);

/// One picture of each, from the direction of draw_recognition()'s. Without a silhouette where
/// the explanation has no cells.
/// @param scene  as given to recognize(). @param scan  that the explanations were made with.
/// @throws InvalidInput if a setting isn't positive or an object names no model of the library.
std::vector<VerdictPicture> draw_verdicts(const PointCloud& scene, const ModelLibrary& library,
                                          const Scan& scan,
                                          std::span<const Explanation> explanations,
                                          const VerdictPictureSettings& settings = {});

}  // namespace ostraka
