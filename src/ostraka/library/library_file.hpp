// SPDX-License-Identifier: Apache-2.0
// The library as one file: an SQLite database (schema in docs/library_format.md).
#pragma once

#include <filesystem>
#include <iosfwd>

#include "ostraka/base/progress.hpp"
#include "ostraka/library/model_library.hpp"

namespace ostraka {

inline constexpr int kLibraryFormat = 2;

/// Writes the library beside `path` and then puts it in place: an earlier file is intact until
/// then, and whole after any failure. The same library gives the same bytes.
/// @throws FileError if it can't be written.
void save_library(const ModelLibrary& library, const std::filesystem::path& path);

/// Reads libraries of this format and every earlier one, and checks their checksums.
/// @throws FileError if the file can't be read; FormatError if it isn't a library, is damaged, or
///         is of a later format version.
ModelLibrary load_library(const std::filesystem::path& path);

/// Names of the models, in order. @throws FileError, FormatError.
std::vector<std::string> model_names(const std::filesystem::path& path);

struct LibraryCheck {
    std::int64_t format = 0;
    std::size_t models = 0;
    std::size_t entries = 0;
    std::string sha256;  ///< of the content: two libraries that hold the same have the same
    std::vector<std::string> problems;  ///< one line each; empty if all is well
};

/// Looks at everything that can be wrong: the database's own structure, checksums, every model.
/// @throws FileError if the file can't be read; FormatError if it isn't a library at all.
LibraryCheck verify_library(const std::filesystem::path& path, const Progress& progress = {});

/// The logical content as text, a line a row, the same for libraries of the same content however
/// they came about.
/// @throws FileError, FormatError.
void dump_library(const std::filesystem::path& path, std::ostream& out);

}  // namespace ostraka
