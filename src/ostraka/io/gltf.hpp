// SPDX-License-Identifier: Apache-2.0
// glTF 2.0 (Khronos), as text with its buffers or as one binary file (GLB), read through assimp.
#pragma once

#include <filesystem>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

/// All triangles of the file's scene with the nodes' transforms applied, in the file's unit (meters
/// by the standard). Header, chunks, buffer ranges and the node tree are checked before assimp sees
/// them.
/// @throws FileError if the file or a buffer beside it can't be read, FormatError otherwise.
TriangleMesh read_gltf(const std::filesystem::path& path);

}  // namespace ostraka
