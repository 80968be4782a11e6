// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/xyz.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

using Path = std::filesystem::path;

constexpr std::size_t kMostUsed = 9;  // columns that can mean something

bool is_separator(char c) {
    return c == ',' || c == ';';
}

// Splits at blanks with at most one comma or semicolon among them, into `words` (replaced). False
// if a column between two separators is empty.
bool split_columns(std::string_view text, std::vector<std::string_view>& words) {
    words.clear();
    std::size_t i = 0;
    const auto skip_blanks = [&] {
        while (i < text.size() && is_blank(text[i])) {
            ++i;
        }
    };
    skip_blanks();
    while (i < text.size()) {
        const std::size_t begin = i;
        while (i < text.size() && !is_blank(text[i]) && !is_separator(text[i])) {
            ++i;
        }
        if (i == begin) {
            return false;
        }
        words.push_back(text.substr(begin, i - begin));
        skip_blanks();
        if (i < text.size() && is_separator(text[i])) {
            ++i;
            skip_blanks();
        }
    }
    return true;
}

// Three columns whose meaning shows only when all lines are read.
struct Triple {
    std::vector<Vec3f> values;
    bool all_bytes = true;  // whole numbers from 0 to 255
    bool above_one = false;

    void add(const double* numbers) {
        for (int i = 0; i < 3; ++i) {
            const double n = numbers[i];
            all_bytes = all_bytes && n >= 0.0 && n <= 255.0 && n == std::floor(n);
            above_one = above_one || n > 1.0;
        }
        values.push_back(Vec3d(numbers[0], numbers[1], numbers[2]).cast<float>());
    }

    void move_to(PointCloud& cloud) {
        if (!all_bytes || !above_one) {
            if (cloud.normals.empty()) {
                cloud.normals = std::move(values);
            }
            return;
        }
        if (!cloud.colors.empty()) {
            return;
        }
        cloud.colors.reserve(values.size());
        for (const Vec3f& v : values) {
            cloud.colors.push_back({static_cast<std::uint8_t>(v.x()),
                                    static_cast<std::uint8_t>(v.y()),
                                    static_cast<std::uint8_t>(v.z())});
        }
    }
};

class XyzParser {
  public:
    XyzParser(std::span<const char> bytes, const Path& path) : lines_(bytes), path_(path) {}

    CloudFile parse() {
        std::string_view line;
        while (lines_.next(line)) {
            line = before(before(line, "#"), "//");
            if (!split_columns(line, words_)) {
                fail("empty column");
            }
            if (!words_.empty() && !is_heading()) {
                parse_row();
            }
        }
        if (cloud_.empty()) {
            fail("no points");
        }
        for (Triple& triple : triples_) {
            if (!triple.values.empty()) {
                triple.move_to(cloud_);
            }
        }
        return {std::move(cloud_), false};
    }

  private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw FormatError(path_, lines_.position(), problem);
    }

    // Column names or the number of points, before the first point.
    bool is_heading() {
        double number = 0.0;
        const bool first = columns_ == 0 && !had_heading_;
        const bool names = !parse_number(words_[0], number) && words_[0].size() < 32 &&
                           words_[0].find_first_not_of("0123456789+-.") == 0;
        had_heading_ = first && (names || words_.size() == 1);
        return had_heading_;
    }

    void parse_row() {
        if (columns_ == 0) {
            columns_ = words_.size();
            if (columns_ < 3) {
                fail(fmt::format("{} columns where at least 3 are expected", columns_));
            }
        }
        if (words_.size() != columns_) {
            fail(fmt::format("{} columns where {} are expected", words_.size(), columns_));
        }
        std::array<double, kMostUsed> row = {};
        const std::size_t used = columns_ >= 9 ? 9 : columns_ == 6 ? 6 : 3;
        for (std::size_t i = 0; i < used; ++i) {
            if (!parse_number(words_[i], row[i])) {
                fail(quote_word(words_[i]) + " is not a number");
            }
        }
        cloud_.points.push_back(Vec3d(row[0], row[1], row[2]).cast<float>());
        for (std::size_t i = 3; i < used; i += 3) {
            triples_[i / 3 - 1].add(row.data() + i);
        }
    }

    LineReader lines_;
    const Path& path_;
    PointCloud cloud_;
    std::array<Triple, 2> triples_;
    std::vector<std::string_view> words_;
    std::size_t columns_ = 0;
    bool had_heading_ = false;
};

}  // namespace

CloudFile parse_xyz(std::span<const char> bytes, const std::filesystem::path& path) {
    return XyzParser(bytes, path).parse();
}

std::string encode_xyz(const PointCloud& cloud) {
    std::string text;
    const auto append = [&](const Vec3f& v) {
        for (const float coordinate : v) {
            append_number(text, coordinate);
            text += ' ';
        }
    };
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        append(cloud.points[i]);
        if (!cloud.normals.empty()) {
            append(cloud.normals[i]);
        }
        if (!cloud.colors.empty()) {
            const auto [red, green, blue] = cloud.colors[i];
            text += fmt::format("{} {} {} ", red, green, blue);
        }
        text.back() = '\n';
    }
    return text;
}

}  // namespace ostraka
