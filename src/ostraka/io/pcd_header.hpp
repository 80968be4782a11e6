// SPDX-License-Identifier: Apache-2.0
// Internal to io: the header of a PCD file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "ostraka/base/types.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {

struct PcdField {
    std::string name;
    std::size_t size = 4;
    char type = 'F';
    std::size_t count = 1;
    std::size_t offset = 0;  // bytes before it in a row
    std::size_t column = 0;  // words before it in a line of text
};

struct PcdHeader {
    std::vector<PcdField> fields;
    std::uint64_t width = 0;
    std::uint64_t height = 1;
    std::uint64_t points = 0;
    std::size_t row_size = 0;  // bytes
    std::size_t columns = 0;   // words
    Vec3f viewpoint = Vec3f::Zero();
    std::string data;
};

/// Reads up to the "DATA" line; `lines` then stands at the first datum. The sizes are consistent
/// with each other, but not yet compared with the bytes that follow.
/// @throws FormatError.
PcdHeader parse_pcd_header(LineReader& lines, const std::filesystem::path& path);

}  // namespace ostraka
