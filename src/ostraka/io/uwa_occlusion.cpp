// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/uwa_occlusion.hpp"

#include "ostraka/base/error.hpp"
#include "ostraka/io/folder_files.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {

std::vector<UwaOcclusion> parse_uwa_occlusion(std::span<const char> bytes,
                                              const std::filesystem::path& path) {
    std::vector<UwaOcclusion> rows;
    std::vector<std::string_view> words;
    LineReader reader(bytes);
    for (std::string_view line; reader.next(line);) {
        split_words(line, words);
        if (words.empty() || (reader.number() == 1 && !whole_number(words[0]))) continue;
        const auto fail = [&](const char* problem) {
            throw FormatError(path, reader.position(), problem);
        };
        if (words.size() != 3) fail("is not \"scene object percent\"");
        UwaOcclusion row{.object = std::string(words[1])};
        const std::optional<int> scene = whole_number(words[0]);
        if (!scene) fail("the scene is not a whole number");
        row.scene = *scene;
        if (!parse_number(words[2], row.percent)) fail("the percentage is not a number");
        if (!(row.percent >= 0.0 && row.percent <= 100.0)) {
            fail("the percentage is not from 0 to 100");
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

bool same_or_longer_name(std::string_view name, std::string_view begin) {
    const std::string key = name_key(begin);
    return !key.empty() && name_key(name).starts_with(key);
}

}  // namespace ostraka
