// SPDX-License-Identifier: Apache-2.0
// The Stanford polygon format (Turk 1994): ASCII and binary of either byte order, any properties.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "ostraka/io/cloud_file.hpp"
#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

/// The vertices and faces of a PLY file held in memory. @param path  for messages only.
/// @throws FormatError.
TriangleMesh parse_ply_mesh(std::span<const char> bytes, const std::filesystem::path& path);

/// The vertices of a PLY file held in memory, with normals (nx or normal_x), colors (red or
/// diffuse_red; floats are taken as 0 to 1), the grid (comments "width W" and "height H", or
/// Stanford's range_grid with "obj_info num_cols", whose empty cells become NaN) and the viewpoint
/// (comment "viewpoint x y z"). @param path  for messages only.
/// @throws FormatError.
CloudFile parse_ply_cloud(std::span<const char> bytes, const std::filesystem::path& path);

/// The content of a binary little endian PLY file. @param mesh  indices in range.
std::string encode_ply(const TriangleMesh& mesh);

/// The same for a cloud; grid and viewpoint become comments. @param cloud  passes check().
std::string encode_ply(const PointCloud& cloud);

}  // namespace ostraka
