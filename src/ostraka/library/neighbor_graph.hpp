// SPDX-License-Identifier: Apache-2.0
// Approximate nearest rows of a large library: a flat graph that is walked toward the query.
// Graph, pruning and search: Subramanya, Devvrit, Kadekodi, Krishnaswamy, Simhadri. DiskANN: Fast
// Accurate Billion-point Nearest Neighbor Search on a Single Node. NeurIPS 2019 (Vamana).
// Deterministic parallel construction: Manohar, Shen, Blelloch, Dhulipala, Gu, Simhadri, Sun.
// ParlayANN: Scalable and Deterministic Parallel Graph-Based Approximate Nearest Neighbor Search
// Algorithms. PPoPP 2024.
// Departs from the papers: rows with the same bytes are one vertex, whose copies hang on a chain;
// vertices that no walk could reach are linked at the end; one pass. See
// docs/approximate_search.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ostraka/library/byte_rows.hpp"

namespace ostraka {

struct NeighborGraphSettings {
    int degree = 32;         ///< numbers stored a row, 4 to 256: links, and one for a copy
    double alpha = 1.2;      ///< at least 1: how much nearer a link's other end must be to make a
                             ///< longer link superfluous; more keeps more long links
    int breadth = 64;        ///< rows kept while a new row looks for its neighbors, at least 1
    std::uint64_t seed = 0;  ///< of the order in which rows enter
};

/// Plain data, to be stored as it is; the rows are kept elsewhere.
struct NeighborGraph {
    std::uint32_t degree = 0;          ///< numbers stored a row
    std::uint32_t start = kNoIndex;    ///< where searches begin: the row nearest to the mean
    std::vector<std::uint32_t> links;  ///< rows x degree. Of each row: first its neighbors, then
                                       ///< kNoIndex; last the next row with the same bytes, or
                                       ///< kNoIndex. Only the first of such rows has neighbors, and
                                       ///< only it is a neighbor
};

/// Memory of a search, for one thread at a time; reused, so that no search allocates. What it
/// holds between searches is of no concern, nor which graph it was used with before.
struct SearchScratch {
    std::vector<std::uint8_t> marks;      ///< per row: the last search that saw it
    std::uint8_t epoch = 0;               ///< number of this search, 1 to 255
    std::vector<std::uint64_t> beam;      ///< nearest rows seen: distance, row, expanded or not
    std::vector<std::uint32_t> fresh;     ///< neighbors not seen before
    std::vector<std::int32_t> distances;  ///< of these
    std::vector<RowMatch> expanded;       ///< rows whose neighbors were looked at, in that order
    std::vector<RowMatch> matches;        ///< the answer
};

/// Builds the graph: the same bits for any number of threads.
/// @param rows  any number, also equal ones.
/// @throws InvalidInput if check(rows) fails or a setting is out of range.
NeighborGraph build_neighbor_graph(const ByteRows& rows,
                                   const NeighborGraphSettings& settings = {});

/// For a graph read from a file: what passes can be searched without harm, though a graph of other
/// rows finds the wrong ones.
/// @throws InvalidInput if the size doesn't fit the row count, a number is no row's, or copies
///         don't ascend.
void check_graph(const NeighborGraph& graph, std::size_t row_count);

/// The rows nearest to a query, nearest first, ties by index; distances are exact.
/// @param graph    of these rows; built here, or passed by check_graph().
/// @param query    rows.length bytes; not checked.
/// @param breadth  rows kept while walking, at least k is taken: more finds more of the truly
///                 nearest and takes longer in proportion.
/// @return min(k, rows.size()) matches in scratch.matches, valid until the scratch's next use.
std::span<const RowMatch> search_graph(const NeighborGraph& graph, const ByteRows& rows,
                                       std::span<const std::uint8_t> query, std::size_t k,
                                       std::size_t breadth, SearchScratch& scratch);

/// The walk itself, without copies. Leaves in scratch.expanded every row whose neighbors it looked
/// at, among them the `breadth` nearest it saw. Parameters as for search_graph().
void walk_graph(const NeighborGraph& graph, const ByteRows& rows, const std::uint8_t* query,
                std::size_t breadth, SearchScratch& scratch);

}  // namespace ostraka
