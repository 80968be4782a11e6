// SPDX-License-Identifier: Apache-2.0
#include "evaluate_output.hpp"

#include "ostraka/base/sha256.hpp"
#include "ostraka/io/atomic_file.hpp"

namespace ostraka::app {

void add_output(CLI::App& command, EvaluationOutput& output) {
    command.add_option("--html", output.html, "write a report with plots and pictures, one file");
    command.add_option("--csv", output.csv,
                       "write the figures as CSV to a file, or to standard output with -");
    command.add_option("--journal", output.journal,
                       "file that keeps what is done: the same command with it goes on after an "
                       "interruption");
    add_common(command, output.common);
}

void write_page(const EvaluationOutput& output, const std::string& title, const std::string& what,
                const PageContent& content) {
    if (output.html.empty()) return;
    write_file_atomically(output.html, html_page({.title = title,
                                                  .subtitle = what,
                                                  .footer = "Made by ostraka " OSTRAKA_VERSION "."},
                                                 content));
    say("report: " + output.html);
}

void write_csv(const std::vector<std::vector<std::string>>& rows, const std::string& path) {
    if (path.empty()) return;
    std::string text;
    for (const std::vector<std::string>& row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (i > 0) text += ',';
            if (row[i].find_first_of(",\"\n") == std::string::npos) {
                text += row[i];
                continue;
            }
            text += '"';
            for (const char c : row[i]) text += c == '"' ? std::string("\"\"") : std::string(1, c);
            text += '"';
        }
        text += '\n';
    }
    write_text(text, path);
}

Json interval_json(const Interval& interval) {
    return {{"value", interval.value}, {"low", interval.low}, {"high", interval.high}};
}

std::string files_digest(const std::vector<std::string>& paths) {
    std::string digests;
    for (const std::string& path : paths) digests += sha256_of_file(path);
    return digests;
}

}  // namespace ostraka::app
