// SPDX-License-Identifier: Apache-2.0
// Where the results of all evaluations go.
#pragma once

#include "common.hpp"
#include "ostraka/evaluation/intervals.hpp"
#include "ostraka/report/page.hpp"

namespace ostraka::app {

struct EvaluationOutput {
    CommonOptions common;
    std::string csv;      // path, "-" or empty
    std::string html;     // path or empty
    std::string journal;  // path or empty
};

/// --json, --csv, --html, --journal, --threads.
void add_output(CLI::App& command, EvaluationOutput& output);

/// Writes the page. @param title  of the page. @param what  of the run, in one line.
void write_page(const EvaluationOutput& output, const std::string& title, const std::string& what,
                const PageContent& content);

/// Writes rows of cells, the first being the header; a cell with a comma or quote is quoted.
void write_csv(const std::vector<std::vector<std::string>>& rows, const std::string& path);

/// {"value", "low", "high"}.
Json interval_json(const Interval& interval);

/// Digests of the files' contents, for the key of a journal.
std::string files_digest(const std::vector<std::string>& paths);

}  // namespace ostraka::app
