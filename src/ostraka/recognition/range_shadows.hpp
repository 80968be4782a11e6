// SPDX-License-Identifier: Apache-2.0
// Where a scan shows nothing because something nearer keeps the sensor's light, or the view of its
// second camera, away: there a missing measurement says nothing of a placed model.
#pragma once

#include <array>
#include <span>

#include "ostraka/recognition/range_cell.hpp"

namespace ostraka {

/// Tangent of the angle between a sensor's camera and its light or second camera, as seen from what
/// is nearest: few have more (docs/sensors.md).
inline constexpr double kParallax = 0.25;

/// The cells of a range map, row by row.
struct CellRows {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    double angle = 0.0;  ///< of a cell, radians
};

/// Distance between the sensor's camera and its light, as far as it casts shadows to one side; the
/// scan's unit. Toward larger columns, smaller ones, larger rows, smaller ones.
using Baselines = std::array<double, 4>;

/// Measures the shadows beside what is nearer than what is behind it: none, of a sensor without
/// parallax; of others to one side, all as long as a baseline makes them.
/// @return infinity where too little is seen to tell.
Baselines measure_baselines(std::span<const RangeCell> cells, const CellRows& rows);

/// Sets RangeCell::shadow. Surface at range r beside an edge at range s is in its shadow for
/// b (1 / s - 1 / r) radians, b the baseline, at most kParallax s.
void mark_shadows(std::span<RangeCell> cells, const CellRows& rows, const Baselines& baselines);

}  // namespace ostraka
