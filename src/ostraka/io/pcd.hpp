// SPDX-License-Identifier: Apache-2.0
// The Point Cloud Library's format, versions 0.5 to 0.7.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "ostraka/io/cloud_file.hpp"

namespace ostraka {

/// A PCD file held in memory: DATA ascii, binary or binary_compressed; fields x y z, normal_x
/// normal_y normal_z and packed rgb or rgba; others are skipped. A HEIGHT above 1 makes it
/// organized; the translation of VIEWPOINT is kept, its rotation not. @param path  for messages
/// only.
/// @throws FormatError.
CloudFile parse_pcd(std::span<const char> bytes, const std::filesystem::path& path);

/// The content of a binary PCD file. @param cloud  passes check().
std::string encode_pcd(const PointCloud& cloud);

}  // namespace ostraka
