// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/markup.hpp"

#include <cstdint>

namespace ostraka {
namespace {

constexpr std::string_view kUnknown = "\xEF\xBF\xBD";  // U+FFFD

std::uint32_t byte_at(std::string_view text, std::size_t i) {
    return static_cast<unsigned char>(text[i]);
}

bool is_valid(std::uint32_t code, std::size_t length) {
    constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
    return code >= kLeast[length] && code <= 0x10FFFF && !surrogate && code != 0xFFFE &&
           code != 0xFFFF;
}

// Bytes of the character of two bytes or more that starts at i; 0: none that XML may hold.
std::size_t character_length(std::string_view text, std::size_t i) {
    const std::uint32_t first = byte_at(text, i);
    std::size_t length = 0;
    if (first >> 5U == 0x06) length = 2;
    if (first >> 4U == 0x0E) length = 3;
    if (first >> 3U == 0x1E) length = 4;
    if (length == 0 || i + length > text.size()) return 0;
    std::uint32_t code = first & (0x7FU >> length);
    for (std::size_t k = 1; k < length; ++k) {
        const std::uint32_t next = byte_at(text, i + k);
        if (next >> 6U != 0x02) return 0;
        code = code << 6U | (next & 0x3FU);
    }
    return is_valid(code, length) ? length : 0;
}

void append_ascii(std::string& out, char c) {
    switch (c) {
        case '&':
            out += "&amp;";
            break;
        case '<':
            out += "&lt;";
            break;
        case '>':
            out += "&gt;";
            break;
        case '"':
            out += "&quot;";
            break;
        case '\'':
            out += "&#39;";
            break;
        default:
            if ((c < ' ' && c != '\n' && c != '\t') || c == '\x7F') {
                out += kUnknown;
            } else {
                out += c;
            }
    }
}

}  // namespace

std::string escape_html(std::string_view text) {
    std::string out;
    out.reserve(text.size() + text.size() / 8);
    for (std::size_t i = 0; i < text.size();) {
        if (byte_at(text, i) < 0x80) {
            append_ascii(out, text[i++]);
            continue;
        }
        const std::size_t length = character_length(text, i);
        out += length == 0 ? kUnknown : text.substr(i, length);
        i += length == 0 ? 1 : length;
    }
    return out;
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = bytes.size() - i < 3 ? bytes.size() - i : 3;
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k)
            word = word << 8U | (k < count ? byte_at(bytes, i + k) : 0U);
        for (std::size_t k = 0; k < 4; ++k) {
            out += k <= count ? kDigits[word >> (18U - 6U * k) & 0x3FU] : '=';
        }
    }
    return out;
}

}  // namespace ostraka
