// SPDX-License-Identifier: Apache-2.0
// What was recognized, to look at: a picture of the scan with its objects, and a colored cloud.
#pragma once

#include "ostraka/io/png_file.hpp"
#include "ostraka/recognition/recognize.hpp"

namespace ostraka {

struct PictureSettings {
    int width = 1280;        ///< pixels, 320 to 8192; the height follows from the scan
    double tolerance = 2.5;  ///< sampling distances between model and scan that count as agreement
    bool labels = true;      ///< name and confidence of each object
    bool header = true;      ///< a line at the top that says how many were found; without it and
                             ///< labels there are no words at all
};

/// The scan as its sensor saw it, in gray. Each object has a color (object_color() of its place in
/// the list): strong where the scan agrees with the placed model, faint where the model is hidden
/// or was not measured, with the outline of the whole model.
/// @param scene  in the library's unit, as given to recognize(); may be empty.
/// @param recognition  what recognize() made of that scan with that library.
/// @throws InvalidInput if a setting is out of range or an object names no model of the library.
Image draw_recognition(const PointCloud& scene, const ModelLibrary& library,
                       const Recognition& recognition, const PictureSettings& settings = {});

/// The scan's valid points in gray, followed by the surface points of each placed model in its
/// color; in the scan's frame and the library's unit, unorganized, without normals.
/// @throws InvalidInput if an object names no model of the library.
PointCloud overlay_cloud(const PointCloud& scene, const ModelLibrary& library,
                         const Recognition& recognition);

}  // namespace ostraka
