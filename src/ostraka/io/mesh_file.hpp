// SPDX-License-Identifier: Apache-2.0
// Triangle meshes from and to files; the extension (any case) names the format.
#pragma once

#include <filesystem>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

/// Reads a mesh: .ply .obj .stl .off .gltf .glb. It only parses: call repair() before using the
/// mesh, which also rejects one without triangles. Polygons become fans of triangles; the vertices
/// of an STL are not welded (three for each triangle); the nodes' transforms of a glTF are applied.
/// @return the mesh in the file's own frame and unit; every index is in range, a coordinate may be
/// NaN.
/// @throws InvalidInput if the extension is not one of these, FileError if the file can't be read,
///         FormatError if its content is not what the format demands.
TriangleMesh read_mesh(const std::filesystem::path& path);

/// Writes a mesh: .ply (binary little endian), .stl (binary), .obj, .off (text, exact for float).
/// The file appears whole or not at all.
/// @throws InvalidInput if the extension is not one of these or an index is out of range, FileError
/// if
///         the file can't be written.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace ostraka
