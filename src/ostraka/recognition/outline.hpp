// SPDX-License-Identifier: Apache-2.0
// Where the visible part of a placed model ends, the scan's surface should end, too: at a depth
// edge. A flat face fits into any wall and a bulge into any ball, but those go on; and into any
// tray, but there the outline is nowhere seen.
// Clutter in the sense of Aldoma, Tombari, Di Stefano, Vincze. A Global Hypotheses Verification
// Method for 3D Object Recognition. ECCV 2012; measured here along the outline only.
#pragma once

#include <span>

#include "ostraka/recognition/cell_check.hpp"

namespace ostraka {

/// What the scan shows where the visible part of a placed model ends. All but `open` and `joined`
/// are of its silhouette: against cells that the model doesn't cover at all.
struct OutlineEvidence {
    double open = 0.0;   ///< share of the outline, also against what hides or contradicts it, where
                         ///< the scan shows one smooth surface on both sides: near 0 for an
                         ///< object, near 1 for a chance fit; 0 if it is too short to judge
    double level = 0.0;  ///< share where the scan is as high beyond, but it isn't that surface
    double folded = 0.0;  ///< share where the scan's surface bends away and goes on: a face that
                          ///< the model lacks (convex: most often of the same object; S. C. Stein
                          ///< et al., Object Partitioning using Local Convexity, CVPR 2014)
    double joined = 0.0;  ///< share of the outline, also against what hides it, where something in
                          ///< front begins at the scan's surface: it grows out of it, or touches it
    double fenced = 0.0;  ///< share where something nearer begins: a plate on the floor of a tray
                          ///< has walls along it. What hides an object hides some of it, too, and
                          ///< hardly ever ends just where the object does
    double ended = 0.0;   ///< cells of outline where the scan ends, too, and something farther or
                          ///< nothing is seen; of the image's two directions in that which has
                          ///< fewer, and twice that: a stripe of a wall ends only above and below
};

/// @param window    cells of a rectangle of the range map, ascending (RangeMap::cells_around()).
/// @param verdicts  one for each of them.
OutlineEvidence judge_outline(const Scan& scan, std::span<const std::uint32_t> window,
                              std::span<const CellVerdict> verdicts);

}  // namespace ostraka
