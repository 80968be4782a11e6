// SPDX-License-Identifier: Apache-2.0
// The library as one file: an SQLite database (schema in docs/library_format.md).
#pragma once

#include <filesystem>

#include "ostraka/library/model_library.hpp"

namespace ostraka {

inline constexpr int kLibraryFormat = 1;

/// Writes the library beside `path` and then puts it in place: an earlier file is intact until
/// then, and whole after any failure. The same library gives the same bytes.
/// @throws FileError if it can't be written.
void save_library(const ModelLibrary& library, const std::filesystem::path& path);

/// @throws FileError if the file can't be read; FormatError if it isn't a library, is damaged, or
/// is of
///         a later format version.
ModelLibrary load_library(const std::filesystem::path& path);

}  // namespace ostraka
