// SPDX-License-Identifier: Apache-2.0
// Checks a placed model against the scan by casting rays from the scan's own viewpoint
// (method, 3.6). Aldoma, Tombari, Di Stefano, Vincze. A Global Hypotheses Verification Method for
// 3D Object Recognition. ECCV 2012 (support, occlusion, clutter); the choice here is greedy.
#pragma once

#include "ostraka/recognition/hypothesis.hpp"
#include "ostraka/recognition/outline.hpp"

namespace ostraka {

/// A hypothesis after verification. Areas count cells of the range map.
struct Verified {
    Hypothesis hypothesis;
    std::size_t silhouette = 0;  ///< cells that the placed model covers
    std::size_t support = 0;     ///< of these: the scan agrees, in distance and normal
    std::size_t hidden = 0;      ///< of these: something is in front
    std::size_t violation = 0;   ///< of these: the scan saw through, or the surface faces elsewhere
    std::size_t missing = 0;     ///< of these: nothing was measured
    double sunk = 0.0;           ///< share of the silhouette that would be below the table
    double open = 0.0;           ///< open_share(): where the model ends, the scan's surface doesn't
    double inlier_rms =
        0.0;  ///< of the distances of supporting cells, along the normal; scan's unit
    double visible_fraction = 0.0;     ///< support / silhouette
    double confidence = 0.0;           ///< 0 to 1
    std::vector<std::uint32_t> cells;  ///< the supporting cells, ascending
};

/// @param tolerance  distance along the normal that counts as agreement, in the scan's unit.
Verified verify(const Scan& scan, const ModelProbe& probe, const Hypothesis& hypothesis,
                double tolerance);

/// Most confident first, keeps those at or above `min_confidence` that explain something which no
/// better one explains. @return the chosen ones, most confident first.
std::vector<Verified> choose(std::vector<Verified> candidates, double min_confidence);

}  // namespace ostraka
