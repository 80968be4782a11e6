// SPDX-License-Identifier: Apache-2.0
// Rows to search in: global SHOT of views and cuts of generated parts, and queries that are not
// among them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace ostraka::bench {

/// comparable_row()s of global SHOT, row-major.
struct IndexRows {
    std::size_t length = 0;      ///< floats a row
    std::vector<float> library;  ///< the rows that are searched
    std::vector<float> queries;  ///< of viewpoints and cut fractions that the library has not

    std::size_t size() const { return library.size() / length; }
    std::size_t query_count() const { return queries.size() / length; }
    std::span<const float> row(std::size_t i) const {
        return std::span(library).subspan(i * length, length);
    }
    std::span<const float> query(std::size_t i) const {
        return std::span(queries).subspan(i * length, length);
    }
};

/// Views of 42 viewpoints of as many parts of varied proportions as it takes, cut along six
/// directions. The same for any number of threads. A million rows take about half an hour.
/// @param count    rows of the library.
/// @param queries  about so many, spread over the models.
/// @param cache    read if it holds exactly these rows, written otherwise; empty: neither.
/// @throws FileError if the cache can't be written.
IndexRows index_rows(std::size_t count, std::size_t queries, const std::filesystem::path& cache);

}  // namespace ostraka::bench
