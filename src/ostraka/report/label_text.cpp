// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/label_text.hpp"

namespace ostraka {
namespace {

constexpr std::string_view kEllipsis = "\xE2\x80\xA6";

bool continues(char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

// Of the font size; shapes of DejaVu Sans, which is wider than Arial, Segoe UI or Roboto.
double share_of_size(char c) {
    constexpr std::string_view kNarrow = "ijlI.,:;'|! ()[]/\\-ftr";
    constexpr std::string_view kWide = "mwMW%@#&+=<>~";
    if (continues(c)) return 0.0;
    if (static_cast<unsigned char>(c) >= 0xE3) return 1.05;  // East Asian, and all beyond
    if (kNarrow.find(c) != std::string_view::npos) return 0.39;
    if (kWide.find(c) != std::string_view::npos) return 0.93;
    return c >= 'A' && c <= 'Z' ? 0.73 : 0.63;
}

// Bytes of whole characters that fit.
std::size_t fitting_bytes(std::string_view text, double size, double width) {
    double used = 0.0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        used += size * share_of_size(text[i]);
        if (used > width) return i;
    }
    return text.size();
}

bool breaks_after(char c) {
    return c == ' ' || c == '_' || c == '-' || c == '/';
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    return text;
}

}  // namespace

double label_width(std::string_view text, double size) {
    double width = 0.0;
    for (const char c : text) width += size * share_of_size(c);
    return width;
}

std::string shortened_label(std::string_view text, double size, double width) {
    if (label_width(text, size) <= width) return std::string(text);
    const double room = width - size * 1.0;  // the ellipsis is one em wide at most
    std::string_view start = text.substr(0, fitting_bytes(text, size, room));
    return std::string(trimmed(start)).append(kEllipsis);
}

std::vector<std::string> wrapped_label(std::string_view text, double size, double width,
                                       std::size_t most) {
    std::vector<std::string> lines;
    std::string_view rest = trimmed(text);
    while (lines.size() + 1 < most && label_width(rest, size) > width) {
        std::size_t end = fitting_bytes(rest, size, width);
        while (end > 0 && !breaks_after(rest[end - 1]) && rest[end] != ' ') --end;
        if (end == 0) break;  // a word wider than a line
        lines.emplace_back(trimmed(rest.substr(0, end)));
        rest = trimmed(rest.substr(end));
    }
    lines.push_back(shortened_label(rest, size, width));
    return lines;
}

}  // namespace ostraka
