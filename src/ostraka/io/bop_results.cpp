// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/bop_results.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>

#include "ostraka/base/error.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/rigid_matrix.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

using Path = std::filesystem::path;

constexpr std::string_view kNames = "scene_id,im_id,obj_id,score,R,t,time";
constexpr double kLargest = 1e9;

// A row that is being read.
class Row {
  public:
    Row(std::string_view line, const LineReader& reader, const Path& path)
        : rest_(line), reader_(reader), path_(path) {}

    [[noreturn]] void fail(const std::string& problem) const {
        throw FormatError(path_, reader_.position(), problem);
    }

    // The next column.
    std::string_view next(const char* name) {
        if (ended_) fail(fmt::format("has no \"{}\"", name));
        const std::size_t comma = rest_.find(',');
        const std::string_view column = rest_.substr(0, comma);
        ended_ = comma == std::string_view::npos;
        rest_.remove_prefix(ended_ ? rest_.size() : comma + 1);
        return column;
    }

    int identifier(const char* name) {
        std::string_view column = next(name);
        const std::optional<int> number = whole_number(next_word(column));
        if (!number || !next_word(column).empty()) {
            fail(fmt::format("\"{}\" is not a whole number", name));
        }
        return *number;
    }

    template <std::size_t N>
    std::array<double, N> numbers(const char* name) {
        std::string_view column = next(name);
        std::array<double, N> values;
        for (double& value : values) {
            if (!parse_number(next_word(column), value) || !(std::abs(value) <= kLargest)) {
                fail(fmt::format("\"{}\" is not {} usable numbers", name, N));
            }
        }
        if (!next_word(column).empty()) fail(fmt::format("\"{}\" has too many numbers", name));
        return values;
    }

    void expect_end() const {
        if (!ended_) fail("has more than 7 columns");
    }

  private:
    std::string_view rest_;
    const LineReader& reader_;
    const Path& path_;
    bool ended_ = false;
};

BopResult result_from(Row& row) {
    BopResult result;
    result.scene = row.identifier("scene_id");
    result.image = row.identifier("im_id");
    result.object = row.identifier("obj_id");
    if (result.object < 1) row.fail("\"obj_id\" is below 1");
    result.score = row.numbers<1>("score")[0];
    const std::array<double, 9> rotation = row.numbers<9>("R");
    const RigidMatrix matrix = rigid_from(rotation, row.numbers<3>("t"));
    if (!matrix.problem.empty()) row.fail(fmt::format("\"R\" {}", matrix.problem));
    result.T_camera_model = matrix.pose;
    result.seconds = row.numbers<1>("time")[0];
    row.expect_end();
    return result;
}

void check(const BopResult& result) {
    if (result.scene < 0 || result.image < 0 || result.object < 1) {
        throw InvalidInput("BOP results: an identifier is too small");
    }
    if (!result.T_camera_model.matrix().allFinite() || !std::isfinite(result.score) ||
        !std::isfinite(result.seconds)) {
        throw InvalidInput("BOP results: a number is not finite");
    }
}

}  // namespace

std::vector<BopResult> read_bop_results(const Path& path) {
    return parse_bop_results(read_file(path).span(), path);
}

std::vector<BopResult> parse_bop_results(std::span<const char> bytes, const Path& path) {
    std::vector<BopResult> results;
    LineReader reader(bytes);
    for (std::string_view line; reader.next(line);) {
        std::string_view words = line;
        const std::string_view first = next_word(words);
        if (first.empty() || (reader.number() == 1 && first == kNames)) continue;
        Row row(line, reader, path);
        results.push_back(result_from(row));
    }
    return results;
}

void write_bop_results(const Path& path, std::span<const BopResult> results) {
    std::string text(kNames);
    text += '\n';
    for (const BopResult& result : results) {
        check(result);
        const Pose& T = result.T_camera_model;
        text += fmt::format("{},{},{},{},{} {} {} {} {} {} {} {} {},{} {} {},{}\n", result.scene,
                            result.image, result.object, result.score, T(0, 0), T(0, 1), T(0, 2),
                            T(1, 0), T(1, 1), T(1, 2), T(2, 0), T(2, 1), T(2, 2), T(0, 3), T(1, 3),
                            T(2, 3), result.seconds);
    }
    write_file_atomically(path, text);
}

}  // namespace ostraka
