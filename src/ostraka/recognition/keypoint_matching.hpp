// SPDX-License-Identifier: Apache-2.0
// Hypotheses from local descriptors (method, 3.4): keypoints of the scan, their nearest rows in the
// library, and poses from single matches (by the local reference frames) and from consistent
// groups. Tombari, Salti, Di Stefano 2010 (SHOT and its frame); Chen, Bhanu. 3D free-form object
// recognition in range images using local surface patches. PRL 28(10), 2007 (geometric
// consistency).
#pragma once

#include "ostraka/library/keypoint_index.hpp"
#include "ostraka/recognition/hypothesis.hpp"

namespace ostraka {

/// For each model the best match of each keypoint of the scan, best first.
std::vector<std::vector<Correspondence>> match_keypoints(const Scan& scan,
                                                         const LibrarySettings& library,
                                                         const KeypointIndex& index,
                                                         const RecognitionSettings& settings);

/// Poses from matches of one model: one from each match alone, and one from each group of matches
/// that keep their distances to a common seed.
/// @param tolerance  difference of distances that counts as kept, in the scan's unit.
std::vector<Pose> poses_from_matches(std::span<const Correspondence> matches, double tolerance);

}  // namespace ostraka
