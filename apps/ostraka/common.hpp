// SPDX-License-Identifier: Apache-2.0
// What all commands share: options, JSON output, progress, tables, exit codes.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "ostraka/base/progress.hpp"
#include "ostraka/base/types.hpp"
#include "ostraka/base/unit.hpp"
#include "ostraka/library/model_library.hpp"

namespace ostraka::app {

using Json = nlohmann::ordered_json;

/// Documented in docs/command_line.md and in `ostraka --help`.
enum ExitCode {
    kOk = 0,
    kInternal = 1,      ///< a bug or lack of memory
    kUsage = 2,         ///< the command line is wrong
    kInvalidInput = 3,  ///< the data can't be used: an empty mesh, a scan of another unit, ...
    kFileError = 4,     ///< a file can't be opened, read or written
    kFormatError = 5,   ///< a file's content is damaged or of another format
    kInterrupted = 130,
};

/// Options of every command.
struct CommonOptions {
    int threads = 0;
    std::string json;  ///< path, "-" or empty
};
void add_common(CLI::App& command, CommonOptions& options);

/// "--unit": the unit of the numbers in the files given.
void add_unit(CLI::App& command, std::string& unit, const std::string& help);
/// The unit named by --unit; without it asks on a terminal, else throws CLI::ValidationError.
Unit require_unit(const std::string& text, const std::string& what);

/// "--viewpoint x,y,z".
void add_viewpoint(CLI::App& command, std::string& text);
std::optional<Vec3f> parse_viewpoint(const std::string& text);

/// The same for "--fractions" and the like: numbers separated by commas.
std::vector<double> parse_numbers(const std::string& text, const std::string& option);

/// Prints to standard output for "-", else writes the file; nothing for an empty path.
void write_text(const std::string& text, const std::string& path);
/// The same of JSON, indented.
void write_json(const Json& json, const std::string& path);
/// Share of likely observations that some entry overlaps by at least 0.5, 0.6, ... .
Json coverage_json(const BuildCounts& counts);
Json pose_json(const Pose& pose, double translation_factor = 1.0);

/// A bar on standard error if it is a terminal, else a line a stage; stops the work on Ctrl-C.
Progress progress_bar();
/// From now on Ctrl-C and SIGTERM ask the work to stop instead of ending the program at once.
void catch_interrupts();

/// Everything a person reads goes to standard error, so that standard output is JSON or empty.
void say(const std::string& line);
/// Aligns columns; the first row is the header.
void say_table(const std::vector<std::vector<std::string>>& rows);

}  // namespace ostraka::app
