// SPDX-License-Identifier: Apache-2.0
// Hypotheses from local descriptors (method, 3.4): keypoints of the scan, their nearest rows in the
// library, and poses from single matches (by the local reference frames) and from consistent
// groups. Tombari, Salti, Di Stefano 2010 (SHOT and its frame); Chen, Bhanu. 3D free-form object
// recognition in range images using local surface patches. PRL 28(10), 2007 (geometric
// consistency).
#pragma once

#include "ostraka/recognition/hypothesis.hpp"

namespace ostraka {

/// One match between a keypoint of the scan and one of a model.
struct Correspondence {
    Vec3f scene_point;
    Vec3f model_point;
    Mat3f R_scene_model;         ///< turns the model keypoint's frame into the scene keypoint's
    std::int32_t distance = -1;  ///< squared, between quantized rows; -1: no match
};

/// Quantized rows widened for comparison, with their squared lengths.
struct WideRows {
    std::vector<std::int16_t> values;   ///< rows x kShotLength
    std::vector<std::int32_t> squares;  ///< per row
};
WideRows widen(std::span<const std::uint8_t> rows);

/// For each model the best match of each keypoint of the scan, best first.
/// @param model_rows  widen() of each model's keypoint rows.
std::vector<std::vector<Correspondence>> match_keypoints(const Scan& scan,
                                                         const ModelLibrary& library,
                                                         std::span<const WideRows> model_rows,
                                                         const RecognitionSettings& settings);

/// Poses from matches of one model: one from each match alone, and one from each group of matches
/// that keep their distances to a common seed.
/// @param tolerance  difference of distances that counts as kept, in the scan's unit.
std::vector<Pose> poses_from_matches(std::span<const Correspondence> matches, double tolerance);

}  // namespace ostraka
