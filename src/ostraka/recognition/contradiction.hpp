// SPDX-License-Identifier: Apache-2.0
// Where the scan contradicts a placed model in a piece, not in specks and lines as noise and edges
// do. Where the model is right, it hardly ever does; where it is another that looks alike, it does.
#pragma once

#include <span>
#include <vector>

#include "ostraka/recognition/cell_check.hpp"

namespace ostraka {

/// Cells that contradict, in violation or backdrop, as do all eight around them.
/// @param ranges    the range map.
/// @param window    cells of a rectangle of it, ascending (RangeMap::cells_around()).
/// @param verdicts  one for each of them.
std::size_t solid_contradiction(const RangeMap& ranges, std::span<const std::uint32_t> window,
                                std::span<const CellVerdict> verdicts);

/// Cells where nothing was measured, nor in the eight around them, although the model's surface
/// there faces the sensor and is in no shadow. Sensors fail in specks and along edges; in a piece
/// they do where the surface is dark or shines, or isn't there.
/// @param ranges, window, verdicts  as above.
std::size_t solid_blank(const RangeMap& ranges, std::span<const std::uint32_t> window,
                        std::span<const CellVerdict> verdicts);

/// Cells that the model covers and that are in holes of the scan's surface: nothing was measured
/// there, or something farther, as in the four beside them. A hole is surrounded by what agrees
/// with the model, and in some cells of it something farther is seen: its wall. What a sensor fails
/// to measure has none, so nothing that is merely missing counts.
/// @param through   for each cell of the window whether something farther than the model is seen
///                  (CellCheck::through). @param ranges, window, verdicts  as above.
std::size_t hollow_contradiction(const RangeMap& ranges, std::span<const std::uint32_t> window,
                                 std::span<const CellVerdict> verdicts,
                                 const std::vector<bool>& through);

}  // namespace ostraka
