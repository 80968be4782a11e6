// SPDX-License-Identifier: Apache-2.0
// Models in, library file out, however many models and however often it is interrupted.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "ostraka/base/progress.hpp"
#include "ostraka/library/library_settings.hpp"
#include "ostraka/library/model_library.hpp"
#include "ostraka/library/model_source.hpp"

namespace ostraka {

/// What became of one model.
struct ModelSummary {
    std::string name;
    double diameter = 0.0;  ///< library unit
    BuildCounts counts;
};

struct BuildOutcome {
    LibrarySettings settings;          ///< completed
    std::vector<ModelSummary> models;  ///< by name
    std::size_t resumed = 0;           ///< models that an earlier, unfinished build had built
};

/// Where an unfinished build of the library at `path` keeps the models that are done.
std::filesystem::path unfinished_build(const std::filesystem::path& path);

/// Builds a library file. Each finished model is stored in unfinished_build(path) at once, and the
/// next build with the same settings goes on from there; the library appears at `path` when it is
/// complete. It has the same bytes as save_library() of build_library().
/// @param models  at least one; distinct names.
/// @param bags    whether to make bags of words (bags.hpp); needs all models in memory at the end.
/// @throws what build_library() throws; FileError, also if another process is building it.
BuildOutcome build_library_file(std::span<const ModelInput> models, LibrarySettings settings,
                                const std::filesystem::path& path, bool bags = false,
                                const Progress& progress = {});

}  // namespace ostraka
