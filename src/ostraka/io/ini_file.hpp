// SPDX-License-Identifier: Apache-2.0
// Internal to io: sections, keys and values as text.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>

namespace ostraka {

/// Keys are "SECTION/KEY" in upper case; values come without quotes and the blanks around them.
using IniFile = std::map<std::string, std::string>;

/// Lines "[SECTION]" and "KEY = VALUE"; lines that begin with ; or # are ignored.
/// @param path  for messages only. @throws FormatError.
IniFile parse_ini(std::span<const char> bytes, const std::filesystem::path& path);

}  // namespace ostraka
