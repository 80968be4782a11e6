// SPDX-License-Identifier: Apache-2.0
// Internal to report: how much room a label takes, and how a long one is made to fit. The reader's
// font isn't known, so widths are those of a wide one: text may end early but won't collide.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ostraka {

/// Pixels at a font size, as an upper estimate for common sans-serif fonts.
double label_width(std::string_view text, double size);

/// The text, or as much of its beginning as fits before an ellipsis. Characters stay whole.
std::string shortened_label(std::string_view text, double size, double width);

/// The text broken at spaces, underscores, hyphens and slashes into lines of at most that width.
/// @return at least one line, at most `most`; what doesn't fit ends in an ellipsis.
std::vector<std::string> wrapped_label(std::string_view text, double size, double width,
                                       std::size_t most);

}  // namespace ostraka
