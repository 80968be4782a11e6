// SPDX-License-Identifier: Apache-2.0
// Results in the form that BOP's evaluation takes: one CSV file a method and data set, see
// docs/bop_challenge_2019_results_format.md of BOP's toolkit.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

struct BopResult {
    int scene = 0;                           ///< "scene_id"
    int image = 0;                           ///< "im_id"
    int object = 1;                          ///< "obj_id"
    double score = 0.0;                      ///< larger is more certain
    Pose T_camera_model = Pose::Identity();  ///< "R" and "t", mm
    double seconds = -1.0;  ///< "time" of the whole image, so the same in all its rows; -1: none
};

/// Reads rows scene_id,im_id,obj_id,score,R,t,time; the row of these names may be missing.
/// Rotations are made exactly orthonormal. @return in the order of the file.
/// @throws FileError, FormatError.
std::vector<BopResult> read_bop_results(const std::filesystem::path& path);

/// The same from memory. @param path  for messages only.
std::vector<BopResult> parse_bop_results(std::span<const char> bytes,
                                         const std::filesystem::path& path);

/// Writes the file, atomically, with all digits.
/// @throws InvalidInput if a number is not finite or, but for `seconds`, an identifier negative;
///         FileError.
void write_bop_results(const std::filesystem::path& path, std::span<const BopResult> results);

}  // namespace ostraka
