// SPDX-License-Identifier: Apache-2.0
// Stereolithography files, binary and ASCII.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

/// An STL file held in memory. A file whose size fits its binary triangle count is binary, whatever
/// its first word; the stored normals are ignored. @param path  for messages only.
/// @return three vertices for each triangle, in the file's order.
/// @throws FormatError.
TriangleMesh parse_stl(std::span<const char> bytes, const std::filesystem::path& path);

/// The content of a binary STL file. @param mesh  indices in range.
std::string encode_stl(const TriangleMesh& mesh);

}  // namespace ostraka
