// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/neighbor_graph.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

// A row of the beam in one number that sorts by distance, then index. Distances have 31 bits.
constexpr std::uint64_t kExpanded = 1;

std::uint64_t key_of(std::int32_t distance, std::uint32_t row) {
    return static_cast<std::uint64_t>(distance) << 33U | static_cast<std::uint64_t>(row) << 1U;
}

std::uint32_t row_of(std::uint64_t key) {
    return static_cast<std::uint32_t>(key >> 1U);
}

std::int32_t distance_of(std::uint64_t key) {
    return static_cast<std::int32_t>(key >> 33U);
}

void begin(std::size_t rows, std::size_t breadth, std::size_t degree, SearchScratch& scratch) {
    if (scratch.marks.size() != rows || scratch.epoch == 255) {
        scratch.marks.assign(rows, 0);
        scratch.epoch = 0;
    }
    ++scratch.epoch;
    scratch.beam.clear();
    scratch.beam.reserve(breadth + 1);
    scratch.expanded.clear();
    scratch.fresh.resize(degree);
    scratch.distances.resize(degree);
}

// The neighbors of a row that this search has not seen yet; returns how many.
std::size_t gather(const NeighborGraph& graph, std::uint32_t row, SearchScratch& scratch) {
    const std::uint32_t* links = graph.links.data() + std::size_t{row} * graph.degree;
    std::size_t count = 0;
    for (std::uint32_t i = 0; i + 1 < graph.degree && links[i] != kNoIndex; ++i) {
        std::uint8_t& mark = scratch.marks[links[i]];
        if (mark == scratch.epoch) continue;
        mark = scratch.epoch;
        scratch.fresh[count++] = links[i];
    }
    return count;
}

// Puts a row in its place in the beam, which stays at most `breadth` long; returns the place.
std::size_t insert(std::uint64_t key, std::size_t breadth, std::vector<std::uint64_t>& beam) {
    if (beam.size() == breadth) {
        if (key > beam.back()) return breadth;
        beam.pop_back();
    }
    const auto place = std::upper_bound(beam.begin(), beam.end(), key);
    return static_cast<std::size_t>(beam.insert(place, key) - beam.begin());
}

// The rows of the beam with their copies, until k are found and no other is as near.
void collect(const NeighborGraph& graph, std::size_t k, SearchScratch& scratch) {
    std::vector<RowMatch>& matches = scratch.matches;
    matches.clear();
    for (const std::uint64_t key : scratch.beam) {
        const std::int32_t distance = distance_of(key);
        if (matches.size() >= k && distance > matches.back().distance) break;
        std::uint32_t row = row_of(key);
        for (std::size_t copies = 0; row != kNoIndex && copies < k; ++copies) {
            matches.push_back({row, distance});
            row = graph.links[(std::size_t{row} + 1) * graph.degree - 1];
        }
    }
    std::sort(matches.begin(), matches.end(), nearer);
    matches.resize(std::min(k, matches.size()));
}

}  // namespace

void walk_graph(const NeighborGraph& graph, const ByteRows& rows, const std::uint8_t* query,
                std::size_t breadth, SearchScratch& scratch) {
    begin(rows.size(), breadth, graph.degree, scratch);
    std::vector<std::uint64_t>& beam = scratch.beam;
    scratch.marks[graph.start] = scratch.epoch;
    beam.push_back(
        key_of(squared_distance(rows.row(graph.start).data(), query, rows.length), graph.start));
    std::size_t next = 0;  // the nearest row that is not expanded yet
    while (next < beam.size()) {
        const std::uint32_t row = row_of(beam[next]);
        scratch.expanded.push_back({row, distance_of(beam[next])});
        beam[next] |= kExpanded;
        const std::size_t count = gather(graph, row, scratch);
        const auto fresh = std::span<const std::uint32_t>(scratch.fresh).first(count);
        squared_distances(rows, query, fresh, scratch.distances.data());
        ++next;
        for (std::size_t i = 0; i < count; ++i) {
            next = std::min(next, insert(key_of(scratch.distances[i], fresh[i]), breadth, beam));
        }
        while (next < beam.size() && (beam[next] & kExpanded) != 0) ++next;
    }
}

std::span<const RowMatch> search_graph(const NeighborGraph& graph, const ByteRows& rows,
                                       std::span<const std::uint8_t> query, std::size_t k,
                                       std::size_t breadth, SearchScratch& scratch) {
    scratch.matches.clear();
    if (k == 0 || graph.start == kNoIndex) return scratch.matches;
    k = std::min(k, rows.size());
    breadth = std::clamp(breadth, k, rows.size());
    walk_graph(graph, rows, query.data(), breadth, scratch);
    collect(graph, k, scratch);
    return scratch.matches;
}

void check_graph(const NeighborGraph& graph, std::size_t row_count) {
    const std::size_t degree = graph.degree;
    if (degree < 4 || degree > 256) {
        throw InvalidInput(fmt::format("neighbor graph: degree {} is not in 4 to 256", degree));
    }
    if (row_count >= kNoIndex || graph.links.size() != row_count * degree) {
        throw InvalidInput(fmt::format("neighbor graph: {} links don't fit {} rows of {}",
                                       graph.links.size(), row_count, degree));
    }
    if (row_count == 0 ? graph.start != kNoIndex : graph.start >= row_count) {
        throw InvalidInput(
            fmt::format("neighbor graph: start {} is not among {} rows", graph.start, row_count));
    }
    for (std::size_t i = 0; i < graph.links.size(); ++i) {
        const std::uint32_t link = graph.links[i];
        if (link == kNoIndex) continue;
        const std::size_t row = i / degree;
        if (link >= row_count) {
            throw InvalidInput(fmt::format("neighbor graph: row {} is linked to {}, not among {}",
                                           row, link, row_count));
        }
        // Ascending chains end, so that a walk along them does.
        if (i % degree == degree - 1 && link <= row) {
            throw InvalidInput(fmt::format(
                "neighbor graph: row {} has the earlier row {} as its next copy", row, link));
        }
    }
}

}  // namespace ostraka
