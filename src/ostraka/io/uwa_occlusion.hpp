// SPDX-License-Identifier: Apache-2.0
// Internal to io: occlusion.txt of the UWA data set.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ostraka {

struct UwaOcclusion {
    int scene = 0;         ///< N of rsN
    std::string object;    ///< as the file names it: "trex", "para"
    double percent = 0.0;  ///< of the surface hidden, as published; 0 to 100
};

/// Lines "scene object percent" after one line of column names. @throws FormatError.
std::vector<UwaOcclusion> parse_uwa_occlusion(std::span<const char> bytes,
                                              const std::filesystem::path& path);

/// Whether `name` begins with `begin`, whatever the case and the punctuation; not if either has no
/// letters: "parasaurolophus" and "para", "T-rex" and "trex", "cheff" and "chef".
bool same_or_longer_name(std::string_view name, std::string_view begin);

}  // namespace ostraka
