// SPDX-License-Identifier: Apache-2.0
// Columns of text: a point a line.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "ostraka/io/cloud_file.hpp"

namespace ostraka {

/// Columns x y z, separated by blanks, a comma or a semicolon; "#" and "//" begin comments; one
/// line of column names or one number (the count) may come first. With 6 columns the last three,
/// with 9 or more both next triples are colors if they are whole numbers from 0 to 255 in every
/// line and one is above 1, else normals. Other columns are ignored. @param path  for messages
/// only.
/// @throws FormatError.
CloudFile parse_xyz(std::span<const char> bytes, const std::filesystem::path& path);

/// Lines "x y z [nx ny nz] [r g b]", exact for float. @param cloud  passes check().
std::string encode_xyz(const PointCloud& cloud);

}  // namespace ostraka
