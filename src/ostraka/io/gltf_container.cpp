// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/gltf_container.hpp"

#include <fmt/format.h>

#include <charconv>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"

namespace ostraka {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& where,
                       const std::string& problem) {
    throw FormatError(path, where, problem);
}

}  // namespace

GltfChunks split_gltf(std::span<const char> bytes, const std::filesystem::path& path) {
    if (bytes.size() < 12 || load<std::uint32_t>(bytes.data()) != kGlbMagic) {
        return {bytes, {}};
    }
    const std::uint32_t version = load<std::uint32_t>(bytes.data() + 4);
    const std::uint32_t length = load<std::uint32_t>(bytes.data() + 8);
    if (version != 2) {
        fail(path, "byte 4", fmt::format("GLB version {}, only 2 is supported", version));
    }
    if (length > bytes.size() || length < 12) {
        fail(path, "byte 8", fmt::format("states {} bytes, the file has {}", length, bytes.size()));
    }
    GltfChunks chunks;
    std::size_t offset = 12;
    while (length - offset >= 8) {
        const std::uint32_t size = load<std::uint32_t>(bytes.data() + offset);
        const std::uint32_t type = load<std::uint32_t>(bytes.data() + offset + 4);
        if (size > length - offset - 8) {
            fail(path, fmt::format("byte {}", offset),
                 fmt::format("chunk of {} bytes, {} are left", size, length - offset - 8));
        }
        const std::span<const char> chunk = bytes.subspan(offset + 8, size);
        if (offset == 12 && type != kGlbJson) {
            fail(path, "byte 16", "the first chunk is not JSON");
        }
        chunks.json = offset == 12 ? chunk : chunks.json;
        chunks.bin = type == kGlbBin && chunks.bin.empty() ? chunk : chunks.bin;
        offset += 8 + size;
    }
    return chunks;
}

std::optional<std::string> decode_base64(std::string_view text) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text.substr(0, text.find('='))) {
        const std::size_t digit = kDigits.find(c);
        if (digit == std::string_view::npos) {
            return std::nullopt;
        }
        bits = bits << 6U | static_cast<std::uint32_t>(digit);
        count += 6;
        if (count >= 8) {
            count -= 8;
            bytes += static_cast<char>(bits >> static_cast<unsigned>(count) & 0xffU);
        }
    }
    return bytes;
}

// "%20" -> " ".
std::string decode_percent(std::string_view uri) {
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        std::uint8_t code = 0;
        const char* digits = uri.data() + i + 1;
        if (uri[i] == '%' && i + 2 < uri.size() &&
            std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
            text += static_cast<char>(code);
            i += 2;
        } else {
            text += uri[i];
        }
    }
    return text;
}

}  // namespace ostraka
