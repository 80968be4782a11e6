// SPDX-License-Identifier: Apache-2.0
// Rows enter in batches that double in size. Every row of a batch walks the graph as it was before
// the batch, so that they don't depend on one another; what they change in older rows is then
// worked out target by target. Threads share both steps without an effect on the result.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"
#include "ostraka/library/neighbor_graph.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kGrain = 16;      // rows that a thread takes at a time
constexpr double kLargestBatch = 0.02;  // of all rows: later ones should see most of the others
constexpr std::size_t kSmallestLimit = 64;

struct Builder {
    ByteRows rows;
    NeighborGraphSettings settings;
    NeighborGraph graph;

    std::size_t most_links() const { return graph.degree - 1; }
    std::span<std::uint32_t> links(std::uint32_t row) {
        return std::span(graph.links).subspan(std::size_t{row} * graph.degree, most_links());
    }
    const std::uint8_t* bytes(std::uint32_t row) const {
        return rows.bytes.data() + std::size_t{row} * rows.length;
    }
    std::int32_t distance(std::uint32_t a, std::uint32_t b) const {
        return squared_distance(bytes(a), bytes(b), rows.length);
    }
};

std::uint64_t hash_of(const std::uint8_t* bytes, std::size_t length) {
    std::uint64_t hash = length;
    for (std::size_t i = 0; i < length; i += 8) {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes + i, std::min<std::size_t>(8, length - i));
        hash = (hash ^ word) * 0x9e3779b97f4a7c15U;
        hash ^= hash >> 29U;
    }
    return hash;
}

// Chains rows with the same bytes, ascending; returns the first of each chain, ascending.
std::vector<std::uint32_t> chain_copies(Builder& builder) {
    const ByteRows& rows = builder.rows;
    std::vector<std::uint64_t> hashes(rows.size());
    parallel_for(
        rows.size(), [&](std::size_t i) { hashes[i] = hash_of(rows.row(i).data(), rows.length); },
        1024);
    std::vector<std::uint32_t> order(rows.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto compare = [&](std::uint32_t a, std::uint32_t b) {
        return std::memcmp(builder.bytes(a), builder.bytes(b), rows.length);
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        if (hashes[a] != hashes[b]) return hashes[a] < hashes[b];
        const int difference = compare(a, b);
        return difference != 0 ? difference < 0 : a < b;
    });
    std::vector<std::uint32_t> firsts;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i > 0 && hashes[order[i - 1]] == hashes[order[i]] &&
            compare(order[i - 1], order[i]) == 0) {
            builder.graph.links[(std::size_t{order[i - 1]} + 1) * builder.graph.degree - 1] =
                order[i];
        } else {
            firsts.push_back(order[i]);
        }
    }
    std::sort(firsts.begin(), firsts.end());
    return firsts;
}

// The row nearest to the mean; the first of its copies, as the lowest index wins ties.
std::uint32_t central_row(const ByteRows& rows) {
    std::vector<std::uint64_t> sums(rows.length, 0);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::span<const std::uint8_t> row = rows.row(i);
        for (std::size_t d = 0; d < rows.length; ++d) sums[d] += row[d];
    }
    std::vector<std::uint8_t> mean(rows.length);
    for (std::size_t d = 0; d < rows.length; ++d) {
        mean[d] = static_cast<std::uint8_t>((sums[d] + rows.size() / 2) / rows.size());
    }
    return exact_nearest(rows, mean, 1).front().row;
}

// In a random order, the start first.
void shuffle(std::vector<std::uint32_t>& order, std::uint32_t start, std::uint64_t seed) {
    Random random(seed);
    for (std::size_t i = order.size(); i > 1; --i) {
        std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
    }
    std::iter_swap(order.begin(), std::find(order.begin(), order.end(), start));
}

// RobustPrune (DiskANN, algorithm 2): nearest candidates first, but none that a chosen one leads
// to. Squared distances, hence alpha squared. Fills the links of `row`.
void choose_links(Builder& builder, std::uint32_t row, std::vector<RowMatch>& candidates) {
    std::sort(candidates.begin(), candidates.end(), nearer);
    const std::span<std::uint32_t> links = builder.links(row);
    const double factor = builder.settings.alpha * builder.settings.alpha;
    std::size_t count = 0;
    for (const RowMatch& candidate : candidates) {
        if (count == links.size()) break;
        if (candidate.row == row) continue;
        const bool superfluous = std::any_of(
            links.begin(), links.begin() + static_cast<std::ptrdiff_t>(count),
            [&](std::uint32_t link) {
                return factor * builder.distance(link, candidate.row) <= candidate.distance;
            });
        if (!superfluous) links[count++] = candidate.row;
    }
    std::fill(links.begin() + static_cast<std::ptrdiff_t>(count), links.end(), kNoIndex);
}

// Adds `sources` to the links of `target`, which are chosen anew where they don't fit.
void add_links(Builder& builder, std::uint32_t target, std::span<const std::uint64_t> sources) {
    const std::span<std::uint32_t> links = builder.links(target);
    const auto free = std::find(links.begin(), links.end(), kNoIndex);
    const auto low_half = [](std::uint64_t pair) { return static_cast<std::uint32_t>(pair); };
    if (sources.size() <= static_cast<std::size_t>(links.end() - free)) {
        std::transform(sources.begin(), sources.end(), free, low_half);
        return;
    }
    thread_local std::vector<RowMatch> candidates;
    candidates.clear();
    for (auto link = links.begin(); link != free; ++link) {
        candidates.push_back({*link, builder.distance(target, *link)});
    }
    for (const std::uint64_t pair : sources) {
        candidates.push_back({low_half(pair), builder.distance(target, low_half(pair))});
    }
    choose_links(builder, target, candidates);
}

void insert_batch(Builder& builder, std::span<const std::uint32_t> batch) {
    const auto breadth = static_cast<std::size_t>(builder.settings.breadth);
    parallel_for(
        batch.size(),
        [&](std::size_t i) {
            thread_local SearchScratch scratch;
            walk_graph(builder.graph, builder.rows, builder.bytes(batch[i]), breadth, scratch);
            choose_links(builder, batch[i], scratch.expanded);
        },
        kGrain);
    std::vector<std::uint64_t> pairs;  // target, source
    for (const std::uint32_t row : batch) {
        for (const std::uint32_t link : builder.links(row)) {
            if (link == kNoIndex) break;
            pairs.push_back(static_cast<std::uint64_t>(link) << 32U | row);
        }
    }
    std::sort(pairs.begin(), pairs.end());
    std::vector<std::size_t> first;  // of each target's pairs
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (i == 0 || pairs[i] >> 32U != pairs[i - 1] >> 32U) first.push_back(i);
    }
    first.push_back(pairs.size());
    parallel_for(
        first.size() - 1,
        [&](std::size_t i) {
            add_links(builder, static_cast<std::uint32_t>(pairs[first[i]] >> 32U),
                      std::span(pairs).subspan(first[i], first[i + 1] - first[i]));
        },
        kGrain);
}

// Which rows can be reached from the start, and the links of a tree that reaches them.
struct Reach {
    std::vector<bool> rows;
    std::vector<bool> tree;  // per link
    std::vector<std::uint32_t> queue;
};

void spread_from(const Builder& builder, std::uint32_t row, Reach& reach) {
    reach.rows[row] = true;
    reach.queue.assign(1, row);
    for (std::size_t i = 0; i < reach.queue.size(); ++i) {
        const std::size_t first = std::size_t{reach.queue[i]} * builder.graph.degree;
        for (std::size_t slot = first; slot < first + builder.most_links(); ++slot) {
            const std::uint32_t link = builder.graph.links[slot];
            if (link == kNoIndex) break;
            if (reach.rows[link]) continue;
            reach.rows[link] = true;
            reach.tree[slot] = true;
            reach.queue.push_back(link);
        }
    }
}

// Links `row` from `from` by a free slot or by one that no row is reached by; false if there is
// none.
bool link_from(Builder& builder, std::uint32_t from, std::uint32_t row, Reach& reach) {
    const std::size_t first = std::size_t{from} * builder.graph.degree;
    std::size_t chosen = kNoIndex;
    for (std::size_t slot = first; slot < first + builder.most_links(); ++slot) {
        const bool free = builder.graph.links[slot] == kNoIndex;
        if (free || !reach.tree[slot]) chosen = slot;
        if (free) break;
    }
    if (chosen == kNoIndex) return false;
    builder.graph.links[chosen] = row;
    reach.tree[chosen] = true;
    return true;
}

// Pruning may leave a row without any link to it. Such a row gets one from the nearest row that
// can spare one.
void connect(Builder& builder, std::span<const std::uint32_t> rows) {
    Reach reach;
    reach.rows.assign(builder.rows.size(), false);
    reach.tree.assign(builder.graph.links.size(), false);
    spread_from(builder, builder.graph.start, reach);
    const auto breadth = static_cast<std::size_t>(builder.settings.breadth);
    SearchScratch scratch;
    for (const std::uint32_t row : rows) {
        if (reach.rows[row]) continue;
        walk_graph(builder.graph, builder.rows, builder.bytes(row), breadth, scratch);
        std::sort(scratch.expanded.begin(), scratch.expanded.end(), nearer);
        const auto offers = [&](std::uint32_t from) {
            return reach.rows[from] && link_from(builder, from, row, reach);
        };
        const bool linked = std::any_of(scratch.expanded.begin(), scratch.expanded.end(),
                                        [&](const RowMatch& match) { return offers(match.row); });
        // A tree has fewer links than rows: somewhere there is one to spare.
        if (!linked) static_cast<void>(std::any_of(rows.begin(), rows.end(), offers));
        spread_from(builder, row, reach);
    }
}

void check_settings(const NeighborGraphSettings& settings) {
    if (settings.degree < 4 || settings.degree > 256) {
        throw InvalidInput(
            fmt::format("neighbor graph: degree {} is not in 4 to 256", settings.degree));
    }
    if (!(settings.alpha >= 1.0 && settings.alpha < 100.0)) {
        throw InvalidInput(
            fmt::format("neighbor graph: alpha {:g} is below 1, or no number", settings.alpha));
    }
    if (settings.breadth < 1) throw InvalidInput("neighbor graph: breadth must be at least 1");
}

}  // namespace

NeighborGraph build_neighbor_graph(const ByteRows& rows, const NeighborGraphSettings& settings) {
    check(rows);
    check_settings(settings);
    Builder builder{.rows = rows, .settings = settings};
    NeighborGraph& graph = builder.graph;
    graph.degree = static_cast<std::uint32_t>(settings.degree);
    graph.links.assign(rows.size() * graph.degree, kNoIndex);
    if (rows.size() == 0) return graph;
    const std::vector<std::uint32_t> firsts = chain_copies(builder);
    graph.start = central_row(rows);
    std::vector<std::uint32_t> order = firsts;
    shuffle(order, graph.start, settings.seed);
    const auto limit =
        std::max(kSmallestLimit,
                 static_cast<std::size_t>(kLargestBatch * static_cast<double>(order.size())));
    for (std::size_t done = 1; done < order.size();) {
        const std::size_t count = std::min({done, limit, order.size() - done});
        insert_batch(builder, std::span(order).subspan(done, count));
        done += count;
    }
    connect(builder, firsts);
    return graph;
}

}  // namespace ostraka
