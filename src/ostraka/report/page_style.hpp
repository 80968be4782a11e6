// SPDX-License-Identifier: Apache-2.0
// Internal to report: the one style sheet of all pages.
#pragma once

#include <string>

namespace ostraka {

std::string page_css();

}  // namespace ostraka
