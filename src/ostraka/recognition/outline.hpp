// SPDX-License-Identifier: Apache-2.0
// The verdicts on a placed model as a picture: where they end, and where they contradict.
// Where the visible part of a placed model ends, the scan's surface should end, too: at a depth
// edge or a crease. A flat face fits into any wall and a bulge into any ball, but those go on.
// Clutter in the sense of Aldoma, Tombari, Di Stefano, Vincze. A Global Hypotheses Verification
// Method for 3D Object Recognition. ECCV 2012; measured here along the outline only.
#pragma once

#include <span>

#include "ostraka/recognition/cell_check.hpp"

namespace ostraka {

/// The share of the supported part's outline, against cells that are outside or hidden, where the
/// scan shows one smooth surface on both sides: near 0 for an object, near 1 for a chance fit.
/// @param window    cells of a rectangle of the range map, ascending (RangeMap::cells_around()).
/// @param verdicts  one for each of them.
/// @return 0 if the outline is too short to judge.
double open_share(const Scan& scan, std::span<const std::uint32_t> window,
                  std::span<const CellVerdict> verdicts);

/// Cells that contradict, in violation or backdrop, as do all eight around them. Where the model is
/// right, noise and edges contradict in specks and lines; where it is another that looks alike,
/// they do in pieces.
/// @param ranges    the range map. @param window, verdicts  as above.
std::size_t solid_contradiction(const RangeMap& ranges, std::span<const std::uint32_t> window,
                                std::span<const CellVerdict> verdicts);

}  // namespace ostraka
