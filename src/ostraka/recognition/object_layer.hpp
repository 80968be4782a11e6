// SPDX-License-Identifier: Apache-2.0
// Where placed models appear in a picture of a scan: their silhouettes, and in these the part that
// the scan shows.
#pragma once

#include <vector>

#include "ostraka/recognition/recognize.hpp"
#include "ostraka/recognition/scan_raster.hpp"

namespace ostraka {

/// One object's part of the picture. Values per pixel of `area`, row-major from the top left.
struct ObjectLayer {
    Rectangle area;                 ///< of the picture; empty if the model isn't in it
    std::vector<float> silhouette;  ///< share of the pixel that the placed model covers, smoothed
    std::vector<float> visible;     ///< share of it where the scan agrees with the model, smoothed
    Vec2d anchor = Vec2d::Zero();   ///< inside the visible part, far from its border; pixels

    /// The picture's pixel of value `i`. @param columns  of the picture.
    std::size_t pixel(std::size_t i, int columns) const {
        const auto width = static_cast<std::size_t>(area.width);
        return (static_cast<std::size_t>(area.y) + i / width) * static_cast<std::size_t>(columns) +
               static_cast<std::size_t>(area.x) + i % width;
    }
    /// The value of a pixel of the picture inside `area`.
    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row - area.y) * static_cast<std::size_t>(area.width) +
               static_cast<std::size_t>(column - area.x);
    }
};

/// One layer an object, in their order. A pixel where the scan agrees with several models belongs
/// to the closest of them.
/// @param recognition  its objects name models of the library.
/// @param tolerance  distance along the model's normal that counts as agreement, the scan's unit.
std::vector<ObjectLayer> object_layers(const ModelLibrary& library, const Recognition& recognition,
                                       const ScanRaster& scan, const PictureCamera& camera,
                                       double tolerance);

}  // namespace ostraka
