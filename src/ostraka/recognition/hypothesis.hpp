// SPDX-License-Identifier: Apache-2.0
// A guess that a model is somewhere, and how well the scan bears it out.
#pragma once

#include <string_view>

#include "ostraka/recognition/model_probe.hpp"
#include "ostraka/recognition/scan.hpp"

namespace ostraka {

/// Where a hypothesis came from.
enum class HypothesisSource { segment, keypoints };
std::string_view source_name(HypothesisSource source);

struct Hypothesis {
    std::uint32_t model = kNoIndex;
    Pose T_scene_model = Pose::Identity();
    HypothesisSource source = HypothesisSource::segment;
    double score = 0.0;  ///< quick_score() of the pose
};

/// What the sensor should see of a placed model against what it measured: counts of surface
/// samples.
struct Evidence {
    int visible = 0;  ///< samples that face the sensor and that the model itself doesn't hide
    int support = 0;  ///< the scan has surface there that faces the same way
    int hidden = 0;   ///< the scan has surface in front: occluded
    int violation =
        0;  ///< the scan saw through it: surface lies behind, or beside with another normal
    int missing = 0;  ///< nothing was measured in that direction
    int sunk = 0;     ///< of the hidden ones, those below the table
};

/// Looks each visible sample of the placed model up in the range map: about 5 microseconds.
/// @param tolerance  distance along the normal that counts as agreement, in the scan's unit.
Evidence gather_evidence(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model,
                         double tolerance);

/// Support less contradiction, as a share of all samples: the measure by which poses of a model are
/// ranked. About -1 to 0.5.
double quick_score(const Evidence& evidence);

}  // namespace ostraka
