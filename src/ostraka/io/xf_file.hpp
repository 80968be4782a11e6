// SPDX-License-Identifier: Apache-2.0
// .xf files: a rigid motion as text, as the UWA and Bologna data sets state where models lie.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Four rows of four numbers separated by blanks, in any lines; the last row is 0 0 0 1. The
/// rotation may be off by 0.02 and is made exactly orthonormal.
/// @return the motion as written; the file states neither unit nor frames.
/// @throws FileError, FormatError.
Pose read_xf(const std::filesystem::path& path);

/// The same from memory. @param path  for messages only.
Pose parse_xf(std::span<const char> bytes, const std::filesystem::path& path);

/// Writes the file, atomically, with all digits.
/// @throws InvalidInput if a number is not finite, FileError.
void write_xf(const std::filesystem::path& path, const Pose& pose);

}  // namespace ostraka
