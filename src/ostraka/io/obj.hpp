// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ: the lines "v" and "f"; everything else is ignored.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

/// An OBJ file held in memory. Faces may be polygons, name vertices as v, v/vt, v//vn or v/vt/vn,
/// and count backward (-1 is the latest vertex). @param path  for messages only.
/// @throws FormatError.
TriangleMesh parse_obj(std::span<const char> bytes, const std::filesystem::path& path);

/// The content of an OBJ file, exact for float. @param mesh  indices in range.
std::string encode_obj(const TriangleMesh& mesh);

}  // namespace ostraka
