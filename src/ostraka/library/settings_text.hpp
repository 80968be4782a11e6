// SPDX-License-Identifier: Apache-2.0
// Library settings as text, one key and value each: what the library file stores.
#pragma once

#include <map>
#include <string>

#include "ostraka/library/library_settings.hpp"

namespace ostraka {

using SettingTexts = std::map<std::string, std::string>;

/// Every setting, by its dotted name. Numbers are written so that they read back exactly.
SettingTexts to_text(const LibrarySettings& settings);

/// The inverse. @throws InvalidInput, naming the key, if one is missing or can't be read.
LibrarySettings settings_from_text(const SettingTexts& texts);

}  // namespace ostraka
