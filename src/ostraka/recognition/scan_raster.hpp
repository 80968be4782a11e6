// SPDX-License-Identifier: Apache-2.0
// Draws a scan as a closed, shaded surface: its points become a grid as dense as the scan itself,
// neighbors without a jump in depth are joined by triangles, and these are filled with a z-buffer.
// Shading by depth: Luft, Colditz, Deussen. Image Enhancement by Unsharp Masking the Depth Buffer.
// SIGGRAPH 2006.
#pragma once

#include <vector>

#include "ostraka/recognition/picture_camera.hpp"

namespace ostraka {

/// Values per pixel of the picture, row-major from the top left.
struct ScanRaster {
    std::vector<float> depth;     ///< along the camera's z axis, the scan's unit; 0: no scan here
    std::vector<float> coverage;  ///< share of the pixel that the scan fills, 0 to 1
    std::vector<float> shade;     ///< brightness where it does, 0 to 1
};

/// @param scene  in any order; invalid points, and those behind the camera, are left out.
ScanRaster rasterize_scan(const PointCloud& scene, const PictureCamera& camera);

/// Brightness of a surface under the pictures' light. @param normal  unit, camera frame, toward the
/// camera. @return 0 to 1.
double shade_of(const Vec3d& normal);

}  // namespace ostraka
