// SPDX-License-Identifier: Apache-2.0
// The letters of the pictures: ASCII 32 to 126 as strokes, drawn for Ostraka, so that text stays
// smooth at any size and needs no font file.
#pragma once

#include <utility>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

inline constexpr double kFontCapHeight = 9.0;  ///< of a capital letter, in font units
inline constexpr double kFontDescent = 2.0;    ///< below the baseline ("g"), in font units

/// One letter. Font units: x right from the letter's left edge, y down, 0 at the capitals' top and
/// kFontCapHeight on the baseline.
struct Glyph {
    std::vector<std::pair<Vec2d, Vec2d>> segments;  ///< of its strokes; both ends equal: a dot
    double advance = 0.0;                           ///< to the next letter's left edge
};

/// The glyph of a character; that of '?' for anything outside ASCII 32 to 126.
const Glyph& glyph(char character);

}  // namespace ostraka
