// SPDX-License-Identifier: Apache-2.0
// One scene folder of a BOP data set: cameras, poses and what is visible, without the images.
// Hodan et al. BOP: Benchmark for 6D Object Pose Estimation. ECCV 2018; the format is described in
// docs/bop_datasets_format.md of BOP's toolkit.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// In pixels. As BOP's toolkit has it, width and height are the differences of the last and the
/// first column and row; -1 in all where nothing is visible or nothing is stated.
struct PixelBox {
    int x = -1;
    int y = -1;
    int width = -1;
    int height = -1;

    bool operator==(const PixelBox&) const = default;
};

/// An object in an image. Counts and boxes: -1 where they are not stated.
struct BopObject {
    int number = 1;                          ///< "obj_id", as in obj_000001.ply
    Pose T_camera_model = Pose::Identity();  ///< mm; camera: x right, y down, z forward
    double visible_fraction = -1.0;          ///< pixels_visible / pixels_all; -1: not stated
    int pixels_all = -1;                     ///< of the silhouette, hidden parts included
    int pixels_valid = -1;                   ///< of it with a depth measured, of whatever surface
    int pixels_visible = -1;                 ///< of it where the object itself is seen
    PixelBox box_all;                        ///< of the silhouette; may go beyond the image
    PixelBox box_visible;                    ///< of the visible part
};

/// Camera of one image; the files don't state the image's size.
struct BopCamera {
    double fx = 1.0;           ///< pixels
    double fy = 1.0;           ///< pixels
    double cx = 0.0;           ///< pixels
    double cy = 0.0;           ///< pixels
    double depth_scale = 1.0;  ///< mm in one step of the depth image
};

/// Everything by the number of the image.
struct BopScene {
    std::map<int, BopCamera> cameras;
    std::map<int, std::vector<BopObject>> objects;
    bool truth_known = false;  ///< false: no scene_gt.json, as of test images kept private
};

/// Reads scene_camera.json and, where they are there, scene_gt.json and scene_gt_info.json.
/// Rotations are made exactly orthonormal; other keys are ignored.
/// @throws FileError, FormatError, also if an image with objects has no camera.
BopScene read_bop_scene(const std::filesystem::path& folder);

/// One image after the other, with all digits.
/// @throws FileError, InvalidInput if a number is not finite.
void write_bop_scene(const std::filesystem::path& folder, const BopScene& scene);

/// The files' contents. @param path  for messages only. @throws FormatError.
std::map<int, BopCamera> parse_scene_camera(std::span<const char> bytes,
                                            const std::filesystem::path& path);
std::map<int, std::vector<BopObject>> parse_scene_gt(std::span<const char> bytes,
                                                     const std::filesystem::path& path);
/// Adds what scene_gt_info.json says to the objects of scene_gt.json. Images without objects here
/// are ignored; a list of another length than the image's is a FormatError.
void parse_scene_gt_info(std::span<const char> bytes, const std::filesystem::path& path,
                         std::map<int, std::vector<BopObject>>& objects);

/// How many instances of an object are to be found in an image.
struct BopTarget {
    int scene = 0;
    int image = 0;
    int object = 1;
    int instances = 1;

    bool operator==(const BopTarget&) const = default;
};

/// test_targets_bop19.json, in the order of the file. @throws FileError, FormatError.
std::vector<BopTarget> read_bop_targets(const std::filesystem::path& path);

/// @throws FileError.
void write_bop_targets(const std::filesystem::path& path, std::span<const BopTarget> targets);

}  // namespace ostraka
