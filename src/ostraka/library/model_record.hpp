// SPDX-License-Identifier: Apache-2.0
// One model with all that a library holds of it: what is built, stored, added and removed at a
// time. Nothing in a record depends on other models.
#pragma once

#include <vector>

#include "ostraka/library/model_library.hpp"

namespace ostraka {

struct ModelRecord {
    Model model;
    std::vector<Entry> entries;            ///< Entry::model is 0
    std::vector<std::vector<float>> rows;  ///< for each of settings.descriptors: entries x length
    std::vector<Spread> spreads;           ///< for each of settings.descriptors; may be empty
};

/// A library of these models, in the order of their names, without a codebook.
/// @throws InvalidInput if two models have one name.
ModelLibrary join_records(const LibrarySettings& settings, std::vector<ModelRecord> records);

/// The inverse, in the library's order.
std::vector<ModelRecord> split_library(ModelLibrary library);

/// At most `budget` entries of each model, evenly taken (thin_out()): what building with this
/// budget gives where Redundancy is `icp` or `none`, except for the models' counts.
ModelLibrary thin_library(const ModelLibrary& library, int budget);

}  // namespace ostraka
