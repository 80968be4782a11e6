// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/xf_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/rigid_matrix.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kNumbers = 16;
constexpr double kLargest = 1e9;

}  // namespace

Pose read_xf(const std::filesystem::path& path) {
    return parse_xf(read_file(path).span(), path);
}

Pose parse_xf(std::span<const char> bytes, const std::filesystem::path& path) {
    std::array<double, kNumbers> numbers;
    std::size_t count = 0;
    LineReader reader(bytes);
    for (std::string_view line; reader.next(line);) {
        for (auto word = next_word(line); !word.empty(); word = next_word(line)) {
            const auto fail = [&](const char* problem) {
                throw FormatError(path, reader.position(), quote_word(word) + problem);
            };
            double value = 0.0;
            if (count == kNumbers) fail(" follows the 16 numbers");
            if (!parse_number(word, value)) fail(" is not a number");
            if (!(std::abs(value) <= kLargest)) fail(" is out of range");
            numbers[count++] = value;
        }
    }
    if (count != kNumbers) {
        throw FormatError(path, "end of file", fmt::format("has {} numbers, not 16", count));
    }
    const RigidMatrix matrix = rigid_from(numbers);
    if (!matrix.problem.empty()) {
        throw FormatError(path, "matrix", std::string(matrix.problem));
    }
    return matrix.pose;
}

void write_xf(const std::filesystem::path& path, const Pose& pose) {
    if (!pose.matrix().allFinite()) {
        throw InvalidInput("write_xf: the pose has a number that is not finite");
    }
    std::string text;
    for (int row = 0; row < 3; ++row) {
        text +=
            fmt::format("{} {} {} {}\n", pose(row, 0), pose(row, 1), pose(row, 2), pose(row, 3));
    }
    write_file_atomically(path, text + "0 0 0 1\n");
}

}  // namespace ostraka
