// SPDX-License-Identifier: Apache-2.0
#include "common.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/io/atomic_file.hpp"

namespace ostraka::app {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void on_signal(int /*signal*/) {
    interrupted = 1;
}

// Draws one stage after the other; a stage shorter than a second leaves no line in a log.
class Bar {
  public:
    bool update(std::string_view stage, std::size_t done, std::size_t total) {
        if (stage != stage_) {
            stage_ = stage;
            watch_ = Stopwatch();
            last_drawn_ = -1.0;
        }
        const double seconds = watch_.seconds();
        const bool last = done == total;
        if (terminal_ && (last || seconds - last_drawn_ > 0.1)) {
            last_drawn_ = seconds;
            draw(done, total, seconds, last);
        } else if (!terminal_ && last && seconds > 1.0) {
            say(fmt::format("{}: {} in {:.1f} s", stage_, total, seconds));
        }
        return interrupted == 0;
    }

  private:
    void draw(std::size_t done, std::size_t total, double seconds, bool last) const {
        constexpr std::size_t kWidth = 30;
        const std::size_t filled = total > 0 ? kWidth * done / total : kWidth;
        const double left = done > 0 ? seconds * double(total - done) / double(done) : 0.0;
        fmt::print(stderr, "\r{:<12} [{}{}] {}/{} {:.0f} s left \x1b[K{}", stage_,
                   std::string(filled, '#'), std::string(kWidth - filled, '.'), done, total, left,
                   last ? "\n" : "");
        std::fflush(stderr);
    }

    bool terminal_ = ::isatty(STDERR_FILENO) == 1;
    std::string stage_;
    Stopwatch watch_;
    double last_drawn_ = -1.0;
};

}  // namespace

void add_common(CLI::App& command, CommonOptions& options) {
    command.add_option("--threads", options.threads, "threads to use; 0: all cores")
        ->check(CLI::NonNegativeNumber)
        ->each([](const std::string& text) { set_thread_count(std::stoi(text)); });
    command.add_option("--json", options.json,
                       "write the result as JSON to a file, or to standard output with -");
}

void add_unit(CLI::App& command, std::string& unit, const std::string& help) {
    command.add_option("--unit", unit, help)->check(CLI::IsMember({"mm", "cm", "m", "in"}));
}

Unit require_unit(const std::string& text, const std::string& what) {
    std::string answer = text;
    if (answer.empty() && ::isatty(STDIN_FILENO) == 1) {
        fmt::print(stderr, "{}\nUnit of the files (mm, cm, m, in)? ", what);
        std::getline(std::cin, answer);
    }
    const std::optional<Unit> unit = parse_unit(answer);
    if (!unit) {
        throw CLI::ValidationError("--unit",
                                   what + "; say which unit that is: --unit mm, cm, m or in");
    }
    return *unit;
}

void add_viewpoint(CLI::App& command, std::string& text) {
    command.add_option(
        "--viewpoint", text,
        "position of the sensor as x,y,z, in the scan's frame and unit (default: what "
        "the file says, else the origin)");
}

std::vector<double> parse_numbers(const std::string& text, const std::string& option) {
    std::vector<double> numbers;
    for (std::size_t start = 0; start <= text.size();) {
        const std::size_t comma = std::min(text.find(',', start), text.size());
        double value = 0.0;
        const auto [stop, problem] =
            std::from_chars(text.data() + start, text.data() + comma, value);
        if (problem != std::errc() || stop != text.data() + comma) {
            throw CLI::ValidationError(option, "can't read numbers from \"" + text + "\"");
        }
        numbers.push_back(value);
        start = comma + 1;
    }
    return numbers;
}

std::optional<Vec3f> parse_viewpoint(const std::string& text) {
    if (text.empty()) return std::nullopt;
    const std::vector<double> numbers = parse_numbers(text, "--viewpoint");
    if (numbers.size() != 3)
        throw CLI::ValidationError("--viewpoint", "needs three numbers: x,y,z");
    return Vec3d(numbers.data()).cast<float>();
}

void write_text(const std::string& text, const std::string& path) {
    if (path.empty()) return;
    if (path == "-") {
        std::cout << text << std::flush;
        if (!std::cout) throw FileError("standard output", "can't be written");
    } else {
        write_file_atomically(path, text);
    }
}

void write_json(const Json& json, const std::string& path) {
    if (!path.empty()) write_text(json.dump(2) + "\n", path);
}

Json coverage_json(const BuildCounts& counts) {
    Json shares = Json::object();
    for (std::size_t i = 0; i < kCoveredOverlaps.size(); ++i) {
        shares[fmt::format("{:.1f}", kCoveredOverlaps[i])] = counts.covered[i];
    }
    return shares;
}

Json pose_json(const Pose& pose, double translation_factor) {
    Json numbers = Json::array();
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            numbers.push_back(pose(row, column) * (column == 3 ? translation_factor : 1.0));
        }
    }
    for (const double value : {0.0, 0.0, 0.0, 1.0}) numbers.push_back(value);
    return numbers;
}

Progress progress_bar() {
    auto bar = std::make_shared<Bar>();
    return [bar](std::string_view stage, std::size_t done, std::size_t total) {
        return bar->update(stage, done, total);
    };
}

void catch_interrupts() {
    struct sigaction action = {};
    action.sa_handler = on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second Ctrl-C ends at once
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

void say(const std::string& line) {
    fmt::print(stderr, "{}\n", line);
}

void say_table(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()), 0);
        for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
    }
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t c = 0; c < row.size(); ++c) {
            line += c == 0 ? fmt::format("{:<{}}", row[c], widths[c])
                           : fmt::format("  {:>{}}", row[c], widths[c]);
        }
        say(line);
    }
}

}  // namespace ostraka::app
