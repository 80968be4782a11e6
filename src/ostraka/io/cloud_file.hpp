// SPDX-License-Identifier: Apache-2.0
// Point clouds from and to files; the extension (any case) names the format.
#pragma once

#include <filesystem>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka {

/// What a file says about a cloud.
struct CloudFile {
    PointCloud cloud;            ///< as stored; a point that is NaN stays and means "no return"
    bool has_viewpoint = false;  ///< the file states where the sensor stood (not at the origin)
};

/// Reads a cloud: .ply .pcd (ASCII and binary), .xyz .txt .asc (columns of text). Of a mesh the
/// vertices are taken. The file's grid, where it has one, is kept.
/// @return points in the file's own frame and unit; normals and colors where the file has them.
/// @throws InvalidInput if the extension is not one of these, FileError if the file can't be read,
///         FormatError if its content is not what the format demands.
CloudFile read_cloud_file(const std::filesystem::path& path);

/// The same without the flag; `viewpoint` is zero where the file doesn't state it.
PointCloud read_cloud(const std::filesystem::path& path);

/// Writes a cloud: .ply and .pcd (binary little endian, with normals, colors, grid and viewpoint),
/// .xyz .txt .asc (columns x y z [nx ny nz] [r g b]; grid and viewpoint are lost).
/// A PCD of one row is read back as unorganized. The file appears whole or not at all.
/// @throws InvalidInput if the extension is not one of these or check(cloud) fails, FileError if
/// the
///         file can't be written.
void write_cloud(const std::filesystem::path& path, const PointCloud& cloud);

}  // namespace ostraka
