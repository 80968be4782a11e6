// SPDX-License-Identifier: Apache-2.0
// Internal to io: the header of a PLY file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace ostraka {

enum class PlyFormat { Ascii, BinaryLittleEndian, BinaryBigEndian };

enum class PlyType { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

/// Bytes of a number in a binary file.
std::size_t size_of(PlyType type);

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::Float32;
    bool is_list = false;
    PlyType count_type = PlyType::Uint8;  ///< of a list's length
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    /// Index into properties of the first with one of these names; -1 if there is none.
    int find(std::span<const char* const> names) const;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::Ascii;
    std::vector<PlyElement> elements;
    std::vector<std::string> notes;  ///< the texts of "comment" and "obj_info" lines
    std::size_t size = 0;            ///< bytes up to the first datum
    std::size_t lines = 0;
};

/// Reads the header and checks that the bytes after it suffice for the counts it states.
/// @throws FormatError.
PlyHeader parse_ply_header(std::span<const char> bytes, const std::filesystem::path& path);

}  // namespace ostraka
