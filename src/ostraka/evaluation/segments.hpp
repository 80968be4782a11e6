// SPDX-License-Identifier: Apache-2.0
// Protocol S: segments cut out of simulated scenes by ground truth, classified by their nearest
// entries (method, section 5).
#pragma once

#include <map>
#include <string>

#include "ostraka/base/progress.hpp"
#include "ostraka/library/retrieval.hpp"
#include "ostraka/simulation/scene.hpp"

namespace ostraka {

struct SegmentSettings {
    int scenes = 60;            ///< random-view scenes
    double min_visible = 0.10;  ///< least visible fraction of a segment
    double max_visible = 0.85;  ///< greatest; 0.85 to 1 are "light" occlusions
    RandomViewSettings views;   ///< noise, seed, density of the scenes
};

/// A piece of a scene that shows one object.
struct LabeledSegment {
    std::uint32_t model = 0;  ///< index into SceneModels
    double visible_fraction = 0.0;
    PointCloud cloud;  ///< at the sampling distance, with normals
};

/// The visible points of each object of simulated scenes.
std::vector<LabeledSegment> simulate_segments(const SceneModels& models,
                                              const SegmentSettings& settings,
                                              const Progress& progress = {});

/// Share of segments whose first-ranked model is right, for each descriptor of the library,
/// "bag_of_words" if it has a codebook, "keypoints" and "fused".
/// @param segments  their model indices count the library's models.
std::map<std::string, double> recognition_rates(const EntryIndex& index,
                                                std::span<const LabeledSegment> segments,
                                                std::size_t k);

}  // namespace ostraka
