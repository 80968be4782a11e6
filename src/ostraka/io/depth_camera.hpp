// SPDX-License-Identifier: Apache-2.0
// The camera of 16-bit depth images, its file camera.json, and the points that an image shows.
#pragma once

#include <filesystem>
#include <optional>

#include "ostraka/base/unit.hpp"
#include "ostraka/cloud/pinhole_camera.hpp"
#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/io/png_file.hpp"

namespace ostraka {

struct DepthCamera {
    PinholeCamera camera;      ///< width and height are 0 where nothing states them
    double depth_scale = 1.0;  ///< length of one step of depth, above 0
    std::optional<Unit> unit;  ///< of that length; nothing: not stated
};

/// Reads {"width", "height", "fx", "fy", "cx", "cy", "depth_scale" (1 if missing), "unit" (may be
/// missing)}; BOP's camera.json has the same keys without the unit, which is mm there.
/// @throws FileError, FormatError.
DepthCamera read_camera_json(const std::filesystem::path& path);

/// Writes such a file, atomically; "unit" only if it is known.
/// @throws InvalidInput if a size or a scale is not positive, FileError.
void write_camera_json(const std::filesystem::path& path, const DepthCamera& camera);

/// The points that a depth image shows, organized, in the camera's frame (x right, y down, z
/// forward); NaN where the depth is 0.
/// @return lengths in the unit of `depth_scale`; the viewpoint is the origin.
/// @throws InvalidInput if the sizes of image and camera differ (unless the camera's are 0) or a
/// focal length or scale isn't positive.
PointCloud depth_cloud(const DepthImage16& image, const DepthCamera& camera);

}  // namespace ostraka
