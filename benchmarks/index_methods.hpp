// SPDX-License-Identifier: Apache-2.0
// Ways to search rows, ours and others', behind one face.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "index_rows.hpp"

namespace ostraka::bench {

struct SearchMethod {
    std::string name;
    std::vector<int> breadths;  ///< values of what the method trades time for recall by, ascending
    std::function<void()> build;
    std::function<std::size_t()> bytes;  ///< what must be in memory to search, after build()
    /// The k rows it takes for nearest. @param query  number of the query.
    std::function<void(std::size_t query, std::size_t k, int breadth, std::uint32_t* found)> search;
};

/// Empty where the library wasn't found when the program was built. The rows must outlive them.
std::vector<SearchMethod> hnswlib_methods(const IndexRows& rows);
std::vector<SearchMethod> faiss_methods(const IndexRows& rows, int threads);

}  // namespace ostraka::bench
