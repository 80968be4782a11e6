// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>
#include <vector>

#include "benchmark.hpp"

namespace ostraka::bench {

/// Prints the table's head, one row, and what it comes to.
void print_head(std::FILE* file);
void print_row(std::FILE* file, const Row& row);
void print_summary(std::FILE* file, const std::vector<Row>& rows);

/// Writes `[{"name", "cloud", "points", "ours_ms", "peer", "peer_ms", "ratio", "goal", "rel_l1"}]`.
/// @throws FileError if the file can't be written.
void write_json(const std::filesystem::path& path, const std::vector<Row>& rows);

}  // namespace ostraka::bench
