// SPDX-License-Identifier: Apache-2.0
// The steps of advise(), each of which adds to the advice what it finds out.
#pragma once

#include "ostraka/evaluation/advice.hpp"

namespace ostraka {

/// Compares settings by protocol S at a distance. @param settings  library.sampling set.
/// @return the library that it recommends.
ModelLibrary choose_library(std::span<const ModelSource> models, const AdviceSettings& settings,
                            double distance, Advice& advice, const Progress& progress);

/// Protocol O at every distance: distances, parts and confusion.
/// @param distances  ascending.
void try_heaps(const ModelLibrary& library, const AdviceSettings& settings,
               std::span<const double> distances, Advice& advice, const Progress& progress);

/// Which part looks like which other, seen from a distance.
std::vector<LookAlike> look_alikes(const ModelLibrary& library, const AdviceSettings& settings,
                                   double distance, const Progress& progress);

}  // namespace ostraka
