// SPDX-License-Identifier: Apache-2.0
// A model before it is in a library: its mesh and where it came from.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

struct ModelSource {
    std::string name;              ///< unique; the file's stem
    TriangleMesh mesh;             ///< repaired; the numbers of the file
    std::string file;              ///< the file's name without its folder; empty if made in memory
    std::string sha256;            ///< of the file; empty if made in memory
    std::size_t cloud_points = 0;  ///< that the surface was rebuilt from; 0 if the file has faces
    double cloud_spacing = 0.0;    ///< distance of these points, in the unit of the file
};

/// Reads and repairs a mesh file. The surface of a file without faces (a PLY, OBJ or OFF of
/// vertices only, or a cloud: PCD, XYZ, TXT, ASC), seen from all around, is rebuilt
/// (rebuild_surface()).
/// @throws FileError, FormatError; InvalidInput, naming the file, if it has no usable surface.
ModelSource load_model(const std::filesystem::path& path);

/// A model that is read when it is needed and then forgotten, so that a library of any number of
/// models can be built.
struct ModelInput {
    std::string name;                     ///< that of the source
    std::string file;                     ///< that of the source
    std::function<ModelSource()> load;    ///< may be called more than once, from one thread at a
                                          ///< time; gives the same each time
    std::function<std::string()> sha256;  ///< of the source, without the mesh being parsed
};

/// @param path  read with load_model().
ModelInput model_input(const std::filesystem::path& path);
/// Of a source in memory, which must outlive the input.
ModelInput model_input(const ModelSource& source);

}  // namespace ostraka
