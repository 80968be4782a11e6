// SPDX-License-Identifier: Apache-2.0
// A model before it is in a library: its mesh and where it came from.
#pragma once

#include <filesystem>
#include <string>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

struct ModelSource {
    std::string name;    ///< unique; the file's stem
    TriangleMesh mesh;   ///< repaired; the numbers of the file
    std::string file;    ///< the file's name without its folder; empty if made in memory
    std::string sha256;  ///< of the file; empty if made in memory
};

/// Reads and repairs a mesh file.
/// @throws FileError, FormatError; InvalidInput, naming the file, if the mesh has no usable
/// surface.
ModelSource load_model(const std::filesystem::path& path);

}  // namespace ostraka
