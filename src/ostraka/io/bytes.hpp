// SPDX-License-Identifier: Apache-2.0
// Internal to io: whole files in memory and numbers of a stated byte order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka {

struct FileBytes {
    std::unique_ptr<char[]> data;
    std::size_t size = 0;

    std::span<const char> span() const { return {data.get(), size}; }
};

/// @param most  bytes to read, from the start.
/// @throws FileError if `path` is missing, not a regular file or can't be read.
FileBytes read_file(const std::filesystem::path& path,
                    std::size_t most = std::numeric_limits<std::size_t>::max());

/// Writes a file that is one of many: neither atomic nor flushed to the disk, for what counts only
/// once the file that lists it is there. @throws FileError.
void write_plain_file(const std::filesystem::path& path, std::string_view bytes);

/// The extension in lower case, with its dot.
std::string lower_extension(const std::filesystem::path& path);

/// The number stored at `bytes` in byte order `order`. @param bytes  at least sizeof(T) of them.
template <class T>
T load(const char* bytes, std::endian order = std::endian::little) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes, sizeof(T));
    if (order != std::endian::native) {
        std::reverse(raw.begin(), raw.end());
    }
    return std::bit_cast<T>(raw);
}

/// Appends `value` in little endian order.
template <class T>
void append_little(std::string& bytes, T value) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (std::endian::native != std::endian::little) {
        std::reverse(raw.begin(), raw.end());
    }
    bytes.append(raw.data(), raw.size());
}

inline void append_little(std::string& bytes, const Vec3f& v) {
    append_little(bytes, v.x());
    append_little(bytes, v.y());
    append_little(bytes, v.z());
}

/// Adds the fan of a polygon's corners `polygon`; nothing for fewer than 3.
void append_fan(std::span<const std::uint32_t> polygon, std::vector<Triangle>& triangles);

/// @throws FormatError if a triangle names a vertex that doesn't exist.
void check_indices(const TriangleMesh& mesh, const std::filesystem::path& path);

}  // namespace ostraka
