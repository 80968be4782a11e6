// SPDX-License-Identifier: Apache-2.0
// Whole evaluations: every scene of a set, with progress, and a journal to go on from.
#pragma once

#include "ostraka/base/progress.hpp"
#include "ostraka/evaluation/journal.hpp"
#include "ostraka/evaluation/scenes.hpp"
#include "ostraka/evaluation/segments.hpp"

namespace ostraka {

/// Protocol S: the segments of all scenes, tried with each library.
/// @param indices  libraries of the same models in the same order. @param journal  of this run.
/// @return trials of each library, in the order of the scenes; the same for any number of threads.
/// @throws InvalidInput if the libraries' models differ; Interrupted.
std::vector<std::vector<SegmentTrial>> run_segments(std::span<const EntryIndex* const> indices,
                                                    const TestSet& set,
                                                    const SegmentSettings& settings,
                                                    Journal& journal,
                                                    const Progress& progress = {});

/// Protocol O: recognizes every scene, one after the other, each with all threads.
/// @throws Interrupted.
std::vector<SceneRecord> run_scenes(const Recognizer& recognizer, const ModelLibrary& library,
                                    const TestSet& set, const SceneSettings& settings,
                                    Journal& journal, const Progress& progress = {});

}  // namespace ostraka
