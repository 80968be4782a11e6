// SPDX-License-Identifier: Apache-2.0
// Internal to io: how glTF 2.0 packs its JSON and its buffers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace ostraka {

inline constexpr std::uint32_t kGlbMagic = 0x46546C67;  // "glTF"
inline constexpr std::uint32_t kGlbJson = 0x4E4F534A;   // "JSON"
inline constexpr std::uint32_t kGlbBin = 0x004E4942;    // "BIN"

struct GltfChunks {
    std::span<const char> json;
    std::span<const char> bin;  ///< empty if the file has none
};

/// The chunks of a GLB; a file without its magic number is all JSON. @throws FormatError.
GltfChunks split_gltf(std::span<const char> bytes, const std::filesystem::path& path);

/// The bytes; none if a character is wrong.
std::optional<std::string> decode_base64(std::string_view text);

/// "a%20b" -> "a b".
std::string decode_percent(std::string_view uri);

}  // namespace ostraka
