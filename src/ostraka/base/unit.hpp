// SPDX-License-Identifier: Apache-2.0
// Length units. Mesh and scan files rarely state theirs, so users do.
#pragma once

#include <optional>
#include <string_view>

namespace ostraka {

enum class Unit { millimeter, centimeter, meter, inch };

/// "mm", "cm", "m" or "in".
std::string_view unit_name(Unit unit);
/// The inverse of unit_name(); nothing for any other text.
std::optional<Unit> parse_unit(std::string_view name);
/// Meters in one unit.
double meters_per(Unit unit);
/// Factor that turns lengths in `from` into lengths in `to`; exactly 1 for equal units.
double unit_factor(Unit from, Unit to);

}  // namespace ostraka
