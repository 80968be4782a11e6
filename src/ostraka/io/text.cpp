// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/text.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <limits>

namespace ostraka {
namespace {

std::string_view without_plus(std::string_view word) {
    const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
    return plus ? word.substr(1) : word;
}

// from_chars says "out of range" for both ends; the exponent's sign tells which. A number without
// an exponent is too small if it begins with zeros.
double out_of_range_value(std::string_view word) {
    const bool negative = word.starts_with('-');
    const std::size_t exponent = word.find_first_of("eE");
    const bool tiny = exponent == std::string_view::npos
                          ? word.substr(negative ? 1 : 0).find_first_not_of("0.") > 1
                          : word.substr(exponent).find('-') != std::string_view::npos;
    const double size = tiny ? 0.0 : std::numeric_limits<double>::infinity();
    return negative ? -size : size;
}

}  // namespace

bool LineReader::next(std::string_view& line) {
    if (offset_ >= text_.size()) {
        return false;
    }
    number_ = following_;
    const std::size_t begin = offset_;
    std::size_t end = begin;
    for (;; end = offset_) {
        ++following_;
        while (end < text_.size() && text_[end] != '\n' && text_[end] != '\r') {
            ++end;
        }
        if (end == text_.size()) {
            offset_ = end;
            break;
        }
        const bool pair = text_[end] == '\r' && end + 1 < text_.size() && text_[end + 1] == '\n';
        offset_ = end + (pair ? 2 : 1);
        if (!continued_ || end == begin || text_[end - 1] != '\\' || offset_ == text_.size()) {
            break;
        }
    }
    line = text_.substr(begin, end - begin);
    return true;
}

std::string LineReader::position() const {
    return fmt::format("line {}", number_);
}

std::string_view next_word(std::string_view& text) {
    std::size_t begin = 0;
    while (begin < text.size() && is_blank(text[begin])) {
        ++begin;
    }
    std::size_t end = begin;
    while (end < text.size() && !is_blank(text[end])) {
        ++end;
    }
    const std::string_view word = text.substr(begin, end - begin);
    text.remove_prefix(end);
    return word;
}

void split_words(std::string_view text, std::vector<std::string_view>& words) {
    words.clear();
    for (std::string_view word = next_word(text); !word.empty(); word = next_word(text)) {
        words.push_back(word);
    }
}

std::string_view before(std::string_view text, std::string_view mark) {
    return text.substr(0, text.find(mark));
}

bool parse_number(std::string_view word, double& value) {
    word = without_plus(word);
    const char* end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (error == std::errc::result_out_of_range && stop == end) {
        value = out_of_range_value(word);
        return true;
    }
    return error == std::errc() && stop == end;
}

bool parse_integer(std::string_view word, std::int64_t& value) {
    word = without_plus(word);
    const char* end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    return error == std::errc() && stop == end;
}

std::optional<int> whole_number(std::string_view text) {
    int number = 0;
    const char* end = text.data() + text.size();
    const auto [stop, problem] = std::from_chars(text.data(), end, number);
    if (problem != std::errc() || stop != end || number < 0 || text.starts_with('-')) {
        return std::nullopt;
    }
    return number;
}

bool equals_ignoring_case(std::string_view word, std::string_view lower) {
    if (word.size() != lower.size()) {
        return false;
    }
    for (std::size_t i = 0; i < word.size(); ++i) {
        const bool upper = word[i] >= 'A' && word[i] <= 'Z';
        if ((upper ? static_cast<char>(word[i] - 'A' + 'a') : word[i]) != lower[i]) {
            return false;
        }
    }
    return true;
}

std::string quote_word(std::string_view word) {
    constexpr std::size_t kLongest = 30;
    std::string text = "\"";
    for (const char c : word.substr(0, kLongest)) {
        text += c >= ' ' && c <= '~' ? c : '?';
    }
    return text + (word.size() > kLongest ? "...\"" : "\"");
}

void append_number(std::string& text, float value) {
    std::array<char, 32> digits;
    const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
    text.append(digits.data(), result.ptr);
}

}  // namespace ostraka
