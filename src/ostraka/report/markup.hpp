// SPDX-License-Identifier: Apache-2.0
// Foreign text and bytes made safe for HTML and SVG.
#pragma once

#include <string>
#include <string_view>

namespace ostraka {

/// Text for an element or a quoted attribute of HTML, SVG or XML: & < > " ' become entities.
/// What XML can't hold (control characters, bytes that aren't UTF-8) becomes U+FFFD.
std::string escape_html(std::string_view text);

/// RFC 4648, section 4: padded, in one line.
std::string base64(std::string_view bytes);

}  // namespace ostraka
