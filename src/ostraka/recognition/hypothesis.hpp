// SPDX-License-Identifier: Apache-2.0
// A guess that a model is somewhere, and how well the scan bears it out.
#pragma once

#include <string_view>

#include "ostraka/recognition/model_probe.hpp"
#include "ostraka/recognition/scan.hpp"

namespace ostraka {

/// Where a hypothesis came from.
enum class HypothesisSource { segment, keypoints, faces };
std::string_view source_name(HypothesisSource source);

struct Hypothesis {
    std::uint32_t model = kNoIndex;
    Pose T_scene_model = Pose::Identity();
    HypothesisSource source = HypothesisSource::segment;
    double score = 0.0;  ///< quick_score() of the pose
};

/// What the sensor should see of a placed model against what it measured: counts of surface
/// samples (cell_check.hpp).
struct Evidence {
    int visible = 0;  ///< samples that face the sensor and that the model itself doesn't hide
    int support = 0;
    int hidden = 0;
    int violation = 0;  ///< contradicted, or claimed by what is a backdrop
    int missing = 0;
    int unsure = 0;
    int sunk = 0;                                   ///< of the visible ones, those below the table
    int samples = static_cast<int>(kProbeSamples);  ///< that were looked at
    double fit = 0.0;  ///< of the supported ones: 1 for each that fits exactly, 0 at the tolerance
};

/// Looks each visible sample of the placed model up in the range map: about 5 microseconds.
/// Where an object that was found already explains the scan, support doesn't count.
/// @param tolerance  distance along the normal that counts as agreement, in the scan's unit.
/// @param samples  so many of the probe's; the first ones are evenly spread, too.
Evidence gather_evidence(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model,
                         double tolerance, std::size_t samples = kProbeSamples);

/// Fit less contradiction, as a share of all samples: the measure by which poses of a model are
/// ranked. About -1 to 0.5.
double quick_score(const Evidence& evidence);

}  // namespace ostraka
