// SPDX-License-Identifier: Apache-2.0
// Internal to io: words and numbers of text, the same in every locale.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ostraka {

inline bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

/// Walks through text line by line; a line ends with \n, \r\n or \r.
class LineReader {
  public:
    /// @param continued  a backslash before the line's end joins the next line to it (OBJ).
    explicit LineReader(std::span<const char> bytes, bool continued = false)
        : text_(bytes.data(), bytes.size()), continued_(continued) {}

    /// False at the end of the text. The line comes without its end.
    bool next(std::string_view& line);
    /// The number of the line last returned, from 1.
    std::size_t number() const { return number_; }
    /// "line 12".
    std::string position() const;
    /// Bytes after the line last returned.
    std::size_t remaining() const { return text_.size() - offset_; }
    std::size_t offset() const { return offset_; }

  private:
    std::string_view text_;
    std::size_t offset_ = 0;
    std::size_t number_ = 0;
    std::size_t following_ = 1;  ///< number of the next line
    bool continued_ = false;
};

/// Takes the next blank-separated word off the front of `text`; empty at the end.
std::string_view next_word(std::string_view& text);

/// Splits into blank-separated words, into `words` (replaced).
void split_words(std::string_view text, std::vector<std::string_view>& words);

/// `text` before the first `mark`.
std::string_view before(std::string_view text, std::string_view mark);

/// The whole word as a number ("nan" and "inf" are numbers; a value out of range becomes 0 or inf).
bool parse_number(std::string_view word, double& value);

/// The whole word as a decimal integer; "3.0" is none.
bool parse_integer(std::string_view word, std::int64_t& value);

/// The whole text as a number from 0, as names of files and keys hold it; leading zeros are fine.
std::optional<int> whole_number(std::string_view text);

/// Equal but for the case of ASCII letters. @param lower  in lower case.
bool equals_ignoring_case(std::string_view word, std::string_view lower);

/// A word of a file for an error message: quoted, short, without control characters.
std::string quote_word(std::string_view word);

/// Appends the shortest text that reads back as the same float.
void append_number(std::string& text, float value);

}  // namespace ostraka
