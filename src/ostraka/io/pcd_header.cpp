// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/pcd_header.hpp"

#include <fmt/format.h>

#include <cmath>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

using Path = std::filesystem::path;

class HeaderParser {
  public:
    HeaderParser(LineReader& lines, const Path& path) : lines_(lines), path_(path) {}

    PcdHeader parse() {
        std::string_view line;
        do {
            if (!lines_.next(line)) {
                fail("file ends before the \"DATA\" line of a PCD header");
            }
            split_words(line, words_);
            if (!words_.empty() && !words_[0].starts_with('#')) {
                parse_line();
            }
        } while (header_.data.empty());
        finish();
        return std::move(header_);
    }

  private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw FormatError(path_, lines_.position(), problem);
    }

    void parse_line() {
        const std::string_view key = words_[0];
        if (key == "FIELDS" || key == "COLUMNS") {
            header_.fields.clear();
            for (std::size_t i = 1; i < words_.size(); ++i) {
                header_.fields.emplace_back().name = words_[i];
            }
        } else if (key == "SIZE" || key == "TYPE" || key == "COUNT") {
            parse_field_line(key);
        } else if (key == "WIDTH") {
            header_.width = parse_count();
        } else if (key == "HEIGHT") {
            header_.height = parse_count();
        } else if (key == "POINTS") {
            header_.points = parse_count();
            has_points_ = true;
        } else if (key == "VIEWPOINT") {
            parse_viewpoint();
        } else if (key == "DATA") {
            parse_data();
        } else if (key != "VERSION") {
            fail("unknown PCD header line " + quote_word(key));
        }
    }

    void parse_field_line(std::string_view key) {
        if (words_.size() != header_.fields.size() + 1) {
            fail(fmt::format("{} has {} values for {} fields", key, words_.size() - 1,
                             header_.fields.size()));
        }
        for (std::size_t i = 0; i < header_.fields.size(); ++i) {
            const std::string_view word = words_[i + 1];
            PcdField& field = header_.fields[i];
            std::int64_t number = 0;
            if (key == "TYPE") {
                field.type = word[0];
                continue;
            }
            // No row can be longer than the file, so larger counts are wrong in any case.
            if (!parse_integer(word, number) || number < 0 ||
                static_cast<std::uint64_t>(number) > lines_.offset() + lines_.remaining()) {
                fail(fmt::format("{} {} is out of range", key, quote_word(word)));
            }
            (key == "SIZE" ? field.size : field.count) = static_cast<std::size_t>(number);
        }
    }

    std::uint64_t parse_count() const {
        std::int64_t number = 0;
        if (words_.size() != 2 || !parse_integer(words_[1], number) || number < 0 ||
            number >= kNoIndex) {
            fail(fmt::format("{} is not a whole number below 2^32", words_[0]));
        }
        return static_cast<std::uint64_t>(number);
    }

    void parse_viewpoint() {
        for (int i = 0; i < 3; ++i) {
            const auto w = static_cast<std::size_t>(i) + 1;
            double value = 0.0;
            if (words_.size() <= w || !parse_number(words_[w], value) || !std::isfinite(value)) {
                fail("VIEWPOINT needs a position");
            }
            header_.viewpoint[i] = static_cast<float>(value);
        }
    }

    void parse_data() {
        if (words_.size() < 2 ||
            (words_[1] != "ascii" && words_[1] != "binary" && words_[1] != "binary_compressed")) {
            fail("DATA must be ascii, binary or binary_compressed");
        }
        header_.data = words_[1];
    }

    void finish() {
        if (!has_points_) {
            header_.points = header_.width * header_.height;
        }
        if (header_.width == 0 && header_.height <= 1) {
            header_.width = header_.points;
        }
        if (header_.width * header_.height != header_.points) {
            fail(fmt::format("WIDTH {} times HEIGHT {} is not POINTS {}", header_.width,
                             header_.height, header_.points));
        }
        for (PcdField& field : header_.fields) {
            check_field(field);
            field.offset = header_.row_size;
            field.column = header_.columns;
            header_.row_size += field.size * field.count;
            header_.columns += field.count;
        }
        if (header_.columns == 0) {
            fail("no FIELDS");
        }
    }

    void check_field(const PcdField& field) const {
        const bool fraction = field.type == 'F' && (field.size == 4 || field.size == 8);
        const bool whole =
            (field.type == 'I' || field.type == 'U') &&
            (field.size == 1 || field.size == 2 || field.size == 4 || field.size == 8);
        if (!fraction && !whole) {
            fail(fmt::format("field {} has unknown type {}{}", quote_word(field.name),
                             quote_word({&field.type, 1}), field.size));
        }
    }

    LineReader& lines_;
    const Path& path_;
    PcdHeader header_;
    bool has_points_ = false;
    std::vector<std::string_view> words_;
};

}  // namespace

PcdHeader parse_pcd_header(LineReader& lines, const std::filesystem::path& path) {
    return HeaderParser(lines, path).parse();
}

}  // namespace ostraka
