// SPDX-License-Identifier: Apache-2.0
// Geomview's object file format, ASCII.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

/// An OFF file held in memory: OFF, COFF, NOFF, STOFF and their mixes; normals, colors and texture
/// columns are skipped. The counts may stand on the first line. @param path  for messages only.
/// @throws FormatError.
TriangleMesh parse_off(std::span<const char> bytes, const std::filesystem::path& path);

/// The content of an OFF file, exact for float. @param mesh  indices in range.
std::string encode_off(const TriangleMesh& mesh);

}  // namespace ostraka
