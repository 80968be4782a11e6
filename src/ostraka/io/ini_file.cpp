// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/ini_file.hpp"

#include "ostraka/base/error.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

std::string upper(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return result;
}

}  // namespace

IniFile parse_ini(std::span<const char> bytes, const std::filesystem::path& path) {
    IniFile result;
    std::string section;
    LineReader reader(bytes);
    for (std::string_view line; reader.next(line);) {
        const auto fail = [&](const char* problem) {
            throw FormatError(path, reader.position(), problem);
        };
        line = trimmed(line);
        if (line.empty() || line[0] == ';' || line[0] == '#') continue;
        if (line[0] == '[') {
            if (line.back() != ']') fail("a section has no ]");
            section = upper(trimmed(line.substr(1, line.size() - 2)));
            continue;
        }
        const std::size_t equals = line.find('=');
        if (equals == std::string_view::npos) fail("is neither [SECTION] nor KEY = VALUE");
        std::string_view value = trimmed(line.substr(equals + 1));
        if (value.starts_with('"')) {
            if (value.size() < 2 || value.back() != '"') fail("a quote is not closed");
            value = value.substr(1, value.size() - 2);
        }
        const std::string key = section + "/" + upper(trimmed(line.substr(0, equals)));
        if (!result.emplace(key, value).second) fail("the key is there twice");
    }
    return result;
}

}  // namespace ostraka
