// SPDX-License-Identifier: Apache-2.0
// Library files that grow, shrink and are put together. What depends on one model only is never
// worked out again, and the content is that of building all models at once (verify_library() gives
// the digest). Each function leaves the file as it was or changed as asked, also after a kill.
// Bags of words (bags.hpp) depend on all models: where the (first) library has them, they are made
// anew, in memory.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "ostraka/base/progress.hpp"
#include "ostraka/library/confidence_model.hpp"
#include "ostraka/library/model_source.hpp"

namespace ostraka {

struct AddOutcome {
    std::size_t added = 0;
    std::size_t present = 0;  ///< were in the library already, from the same file
};

/// Builds models with the library's own settings and puts them in, each as soon as it is built:
/// after an interruption the same call does what is left.
/// @param models  meshes in the library's unit.
/// @throws InvalidInput, before anything is built, if a name is taken by another model; what
///         build_records() throws.
AddOutcome add_models(const std::filesystem::path& library, std::span<const ModelInput> models,
                      const Progress& progress = {});

/// @throws InvalidInput if a name is not in the library, or no model would be left.
void remove_models(const std::filesystem::path& library, std::span<const std::string> names);

/// @throws InvalidInput if there is no model of the old name, or the new one is empty or taken.
void rename_model(const std::filesystem::path& library, const std::string& from,
                  const std::string& to);

/// Stores how a library's own models are to be judged (calibrate_confidence()). What changes the
/// models later makes it void. @throws as remove_models().
void set_confidence(const std::filesystem::path& library, const ConfidenceModel& confidence,
                    ScanKind kind = ScanKind::one_viewpoint);

/// Builds a graph of all models' keypoint rows and stores it, so that scans are matched with the
/// nearest rows only (keypoint_index.hpp): faster from some dozens of models on, and approximate. A
/// change of models makes it void; then this is to be called again.
/// @return the number of rows. @throws InvalidInput if no model has keypoints.
std::size_t index_keypoints(const std::filesystem::path& library);

/// All models of several libraries of equal settings: the same file, byte by byte, as built at once
/// with these settings (`sampling` given, as it otherwise depends on all models).
/// @param output  may be one of the libraries.
/// @throws InvalidInput if there are none, settings differ (naming the first that does) or two
///         models have one name.
void merge_libraries(std::span<const std::filesystem::path> libraries,
                     const std::filesystem::path& output, const Progress& progress = {});

}  // namespace ostraka
