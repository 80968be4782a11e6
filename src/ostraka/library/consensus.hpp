// SPDX-License-Identifier: Apache-2.0
// How well a piece's keypoint matches with each model agree on one pose of that model.
// Johnson, Hebert. Surface Matching for Object Recognition in Complex Three-Dimensional Scenes.
// Image and Vision Computing 16, 1998 (geometric consistency). Chen, Bhanu. 3D Free-Form Object
// Recognition in Range Images Using Local Surface Patches. PRL 28(10), 2007.
// Departs from the papers: a match carries a whole pose by its two frames, so one match is a
// hypothesis and the others vote on it; a vote counts less the more another model is alike.
#pragma once

#include <span>
#include <vector>

#include "ostraka/library/keypoint_index.hpp"

namespace ostraka {

struct ConsensusSettings {
    double tolerance = 2.5;  ///< of distances between matched points, in sampling distances
    double lever = 0.25;     ///< of a point predicted by another match: its error grows by so much
                             ///< of their distance, as frames are unsure
    double max_angle = 0.5;  ///< radians between the rotations of agreeing matches
    double rivalry = 1.0;    ///< a match counts exp(-excess / (rivalry x the median distance)),
                             ///< where excess is how much nearer the best model's match is
};

/// The weighted share of keypoints whose matches with a model agree with the pose claimed by one of
/// them: the best such pose of each model.
/// @param matches   KeypointIndex::match(): for each model, one per scene keypoint in the same
///                  order, or none at all.
/// @param sampling  the library's sampling distance.
/// @return for each model, 0 to 1.
std::vector<double> keypoint_consensus(std::span<const std::vector<Correspondence>> matches,
                                       double sampling, const ConsensusSettings& settings = {});

}  // namespace ostraka
