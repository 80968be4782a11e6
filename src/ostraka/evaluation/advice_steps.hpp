// SPDX-License-Identifier: Apache-2.0
// The steps of advise(), each of which adds to the advice what it finds out.
#pragma once

#include <map>
#include <optional>

#include "ostraka/evaluation/advice.hpp"

namespace ostraka {

struct Candidates {
    ModelLibrary small;                 ///< the smallest good one
    std::optional<ModelLibrary> usual;  ///< none if `small` is the usual one
};
/// Compares settings by protocol S at a distance. @param settings  library.sampling set.
Candidates choose_library(std::span<const ModelSource> models, const AdviceSettings& settings,
                          double distance, Advice& advice, const Progress& progress);

/// Protocol O at one distance: the same heaps from the same side at each.
TestSet heaps_at(const ModelLibrary& library, const AdviceSettings& settings, double distance);

/// By distance, what was recognized in its heaps.
using HeapRecords = std::map<double, std::vector<SceneRecord>>;

/// Compares both libraries in heaps at a distance. @param known  gets the recommended one's
/// records.
/// @return the recommended library.
ModelLibrary confirm_library(Candidates candidates, const AdviceSettings& settings, double distance,
                             Advice& advice, HeapRecords& known, const Progress& progress);

/// Recognizes heaps. @param stage  for the progress.
std::vector<SceneRecord> recognize_heaps(const ModelLibrary& library,
                                         const AdviceSettings& settings, double distance,
                                         const std::string& stage, const Progress& progress);

/// Protocol O at every distance: distances, parts and confusion.
/// @param distances  ascending. @param known  records that are there already.
void try_heaps(const ModelLibrary& library, const AdviceSettings& settings,
               std::span<const double> distances, HeapRecords known, Advice& advice,
               const Progress& progress);

/// Which part looks like which other, seen from a distance.
std::vector<LookAlike> look_alikes(const ModelLibrary& library, const AdviceSettings& settings,
                                   double distance, const Progress& progress);

}  // namespace ostraka
