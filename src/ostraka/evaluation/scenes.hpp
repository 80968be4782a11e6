// SPDX-License-Identifier: Apache-2.0
// Protocol O: the whole pipeline on whole scans, told nothing about what is there (method, section
// 5).
#pragma once

#include <vector>

#include "ostraka/recognition/recognize.hpp"
#include "ostraka/simulation/scene.hpp"

namespace ostraka {

/// A report or a true object, matched or not.
struct Outcome {
    std::uint32_t model =
        kNoIndex;  ///< of the truth for hits and misses, of the report for false ones
    double visible_fraction = 0.0;  ///< of the truth; 0 for false reports
    double confidence = 0.0;        ///< of the report; 0 for misses
    double adi = -1.0;              ///< in model diameters; -1 where there is no pair
};

struct SceneOutcome {
    std::vector<Outcome> hits;    ///< right model, ADI below the limit
    std::vector<Outcome> misses;  ///< true objects at least `min_visible` visible without a hit
    std::vector<Outcome> wrong;   ///< reports that match no true object
};

struct MatchSettings {
    double max_adi = 0.10;      ///< in model diameters
    double min_visible = 0.15;  ///< true objects less visible are ignored: neither hit nor miss
};

/// Pairs reports with true objects, each at most once, smallest error first.
SceneOutcome match_outcome(const Recognition& recognition, std::span<const TrueObject> truth,
                           const ModelLibrary& library, const MatchSettings& settings = {});

struct SceneSummary {
    std::size_t objects = 0;  ///< hits and misses
    std::size_t hits = 0;
    std::size_t wrong = 0;
    double recall = 0.0;      ///< hits / objects
    double precision = 1.0;   ///< hits / (hits + wrong)
    double median_adi = 0.0;  ///< of hits, in model diameters
};
SceneSummary summarize(std::span<const SceneOutcome> outcomes);

}  // namespace ostraka
