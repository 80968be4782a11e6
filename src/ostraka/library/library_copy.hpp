// SPDX-License-Identifier: Apache-2.0
// Writes a whole library file, model by model. Private.
#pragma once

#include <filesystem>
#include <functional>

#include "ostraka/library/library_store.hpp"

namespace ostraka {

/// A new file with these models, in place of what was at `path`, at once and as a whole.
/// @param record    the i-th model by name. Called once each, in order.
/// @param bags      whose codebook and bags to store; nullptr: none.
/// @throws FileError.
void write_library(const std::filesystem::path& path, const LibrarySettings& settings,
                   std::size_t count, const std::function<StoredRecord(std::size_t)>& record,
                   const ModelLibrary* bags = nullptr);

/// All records of an open library, in memory, without codebook and bags.
/// @throws FormatError, naming what is damaged.
ModelLibrary load_store(LibraryStore& store);

/// Replaces codebook and bags by ones made of all models; within a Transaction.
void make_bags_anew(LibraryStore& store);

}  // namespace ostraka
