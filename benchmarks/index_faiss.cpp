// SPDX-License-Identifier: Apache-2.0
// faiss: Johnson, Douze, Jegou. Billion-Scale Similarity Search with GPUs. IEEE Transactions on Big
// Data 7(3), 2021. Its graph and its inverted lists, both on 8-bit rows.
#include <faiss/IndexHNSW.h>
#include <faiss/IndexIVF.h>
#include <faiss/index_factory.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "index_methods.hpp"

namespace ostraka::bench {
namespace {

constexpr std::size_t kTraining = 40;  // rows a list that lists are learned from

void search_one(faiss::Index& index, std::span<const float> query, std::size_t k,
                std::uint32_t* found) {
    std::vector<float> distances(k);
    std::vector<faiss::Index::idx_t> labels(k);
    index.search(1, query.data(), static_cast<faiss::Index::idx_t>(k), distances.data(),
                 labels.data());
    for (std::size_t i = 0; i < k; ++i) found[i] = static_cast<std::uint32_t>(labels[i]);
}

void fill(faiss::Index& index, const IndexRows& rows, std::size_t training, int threads) {
    omp_set_num_threads(threads);
    std::vector<float> sample;
    const std::size_t stride = std::max<std::size_t>(1, rows.size() / training);
    for (std::size_t i = 0; i < rows.size(); i += stride) {
        sample.insert(sample.end(), rows.row(i).begin(), rows.row(i).end());
    }
    index.train(static_cast<faiss::Index::idx_t>(sample.size() / rows.length), sample.data());
    index.add(static_cast<faiss::Index::idx_t>(rows.size()), rows.library.data());
    omp_set_num_threads(1);
}

SearchMethod graph_method(const IndexRows& rows, int threads) {
    const auto index = std::make_shared<std::unique_ptr<faiss::IndexHNSWSQ>>();
    SearchMethod method{.name = "faiss HNSW16 on SQ8"};
    method.breadths = {10, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512};
    method.build = [=, &rows] {
        *index = std::make_unique<faiss::IndexHNSWSQ>(static_cast<int>(rows.length),
                                                      faiss::ScalarQuantizer::QT_8bit, 16);
        (*index)->hnsw.efConstruction = 100;
        fill(**index, rows, 100'000, threads);
    };
    method.bytes = [=, &rows] {
        const faiss::HNSW& graph = (*index)->hnsw;
        return graph.neighbors.size() * sizeof(graph.neighbors[0]) +
               rows.size() * (rows.length + sizeof(std::size_t) + sizeof(int));
    };
    method.search = [=, &rows](std::size_t query, std::size_t k, int breadth,
                               std::uint32_t* found) {
        (*index)->hnsw.efSearch = breadth;
        search_one(**index, rows.query(query), k, found);
    };
    return method;
}

// Not product-quantized: training that takes minutes even for 3,000 rows, as Debian builds it.
SearchMethod list_method(const IndexRows& rows, int threads) {
    const auto lists = static_cast<std::size_t>(std::sqrt(static_cast<double>(rows.size())));
    const auto index = std::make_shared<std::unique_ptr<faiss::Index>>();
    const std::string description = "IVF" + std::to_string(lists) + ",SQ8";
    SearchMethod method{.name = "faiss " + description};
    method.breadths = {2, 4, 8, 16, 24, 32, 48, 64, 96, 128};
    method.build = [=, &rows] {
        index->reset(faiss::index_factory(static_cast<int>(rows.length), description.c_str()));
        fill(**index, rows, kTraining * lists, threads);
    };
    method.bytes = [=, &rows] {
        return rows.size() * (sizeof(faiss::Index::idx_t) + rows.length) +
               lists * rows.length * sizeof(float);
    };
    method.search = [=, &rows](std::size_t query, std::size_t k, int breadth,
                               std::uint32_t* found) {
        dynamic_cast<faiss::IndexIVF&>(**index).nprobe = static_cast<std::size_t>(breadth);
        search_one(**index, rows.query(query), k, found);
    };
    return method;
}

}  // namespace

std::vector<SearchMethod> faiss_methods(const IndexRows& rows, int threads) {
    return {graph_method(rows, threads), list_method(rows, threads)};
}

}  // namespace ostraka::bench
