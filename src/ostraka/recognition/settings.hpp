// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Everything that decides what recognize() reports. Distances count sampling distances of the
/// library.
struct RecognitionSettings {
    double min_confidence = 0.94;   ///< objects below it are not reported
    bool viewpoint_known = true;    ///< false: the scan was merged of several, nobody knows from
                                    ///< where; then free space can't contradict a hypothesis
    std::vector<Vec3f> viewpoints;  ///< of a merged scan, library unit; empty: the cloud's own
    bool remove_plane = true;       ///< look for tables, walls and floors and leave them out
    double tolerance = 1.5;         ///< distance of model from scan that counts as agreement
    int segment_matches = 12;       ///< entries tried for each segment
    int max_keypoints = 1500;       ///< of the scan; more are thinned out evenly
    double keypoint_spacing = 3.0;  ///< between the scan's keypoints
    int candidates_per_model = 40;  ///< poses of each model that are refined coarsely
    int finalists_per_model = 10;   ///< of those, poses that are refined finely and verified
    bool use_segments = true;       ///< source of hypotheses: segments and their global descriptors
    bool use_keypoints = true;      ///< source of hypotheses: local descriptors
    bool use_faces = true;          ///< source of hypotheses: flat faces, of models that have them
    double time_limit = 0.0;  ///< seconds after which what is best by then is reported; then the
                              ///< result depends on the machine; 0: no limit
    std::vector<std::uint32_t> only;  ///< models of the library to look for; empty: all
    bool keep_candidates = false;     ///< also give what was verified but not reported
};

}  // namespace ostraka
