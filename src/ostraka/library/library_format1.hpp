// SPDX-License-Identifier: Apache-2.0
// Reads libraries of format 1 (versions before checksums). Private. Their ESF rows are those of an
// earlier random generator: still comparable, a little less alike.
#pragma once

#include <filesystem>

#include "ostraka/library/model_library.hpp"

namespace ostraka {

/// @param path  of a library whose format is 1. @throws FileError, FormatError.
ModelLibrary load_library_format1(const std::filesystem::path& path);

}  // namespace ostraka
