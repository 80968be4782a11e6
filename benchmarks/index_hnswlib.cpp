// SPDX-License-Identifier: Apache-2.0
// hnswlib: Malkov, Yashunin. Efficient and Robust Approximate Nearest Neighbor Search Using
// Hierarchical Navigable Small World Graphs. IEEE TPAMI 42(4), 2020.
#include <hnswlib/hnswlib.h>

#include <memory>

#include "index_methods.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka::bench {
namespace {

constexpr std::size_t kLinks = 16;          // M: 32 links a row at the bottom, as many as ours
constexpr std::size_t kBuildBreadth = 100;  // ef_construction

struct Index {
    explicit Index(const IndexRows& rows)
        : space(rows.length), graph(&space, rows.size(), kLinks, kBuildBreadth) {}
    hnswlib::L2Space space;
    hnswlib::HierarchicalNSW<float> graph;
};

}  // namespace

std::vector<SearchMethod> hnswlib_methods(const IndexRows& rows) {
    const auto index = std::make_shared<std::unique_ptr<Index>>();
    SearchMethod method{.name = "hnswlib, float, M 16"};
    method.breadths = {10, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512};
    method.build = [index, &rows] {
        *index = std::make_unique<Index>(rows);
        (*index)->graph.addPoint(rows.row(0).data(), 0);
        parallel_for(rows.size() - 1, [&](std::size_t i) {
            (*index)->graph.addPoint(rows.row(i + 1).data(), i + 1);
        });
    };
    method.bytes = [index, &rows] {
        return rows.size() * ((*index)->graph.size_data_per_element_ + sizeof(void*));
    };
    method.search = [index, &rows](std::size_t query, std::size_t k, int breadth,
                                   std::uint32_t* found) {
        (*index)->graph.setEf(static_cast<std::size_t>(breadth));
        auto queue = (*index)->graph.searchKnn(rows.query(query).data(), k);
        for (std::size_t i = 0; !queue.empty(); queue.pop()) {
            found[i++] = static_cast<std::uint32_t>(queue.top().second);
        }
    };
    return {method};
}

}  // namespace ostraka::bench
