// SPDX-License-Identifier: Apache-2.0
// Internal to io: reduces a glTF 2.0 file to its geometry, with everything checked, so that assimp
// never sees an offset, count or node tree that could lead it astray.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace ostraka {

/// @param bytes  the file: JSON or GLB. @param path  its path, for messages and the buffers beside
/// it.
/// @return a GLB with one buffer that holds only nodes, meshes, positions and indices; empty if no
/// node
///         holds a mesh.
/// @throws FileError if a buffer beside the file can't be read, FormatError if the file is damaged.
std::string sanitize_gltf(std::span<const char> bytes, const std::filesystem::path& path);

}  // namespace ostraka
