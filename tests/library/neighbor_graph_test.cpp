// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/neighbor_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kLength = 48;

struct Problem {
    std::vector<std::uint8_t> bytes;
    std::vector<std::uint8_t> queries;

    ByteRows rows() const { return {bytes, kLength}; }
    std::size_t query_count() const { return queries.size() / kLength; }
    std::span<const std::uint8_t> query(std::size_t i) const {
        return std::span(queries).subspan(i * kLength, kLength);
    }
};

// Rows in clusters of different spread, one after another, as the rows of models are.
Problem clustered(std::size_t rows, std::size_t clusters, std::size_t queries) {
    Problem problem;
    for (std::size_t i = 0; i < rows + queries; ++i) {
        const std::size_t cluster = i < rows ? i * clusters / rows : i % clusters;
        Random center(1, cluster);
        Random random(2, i);
        const double spread = center.uniform(3.0, 30.0);
        for (std::size_t d = 0; d < kLength; ++d) {
            const double value = center.uniform(40.0, 210.0) + spread * random.normal();
            auto& target = i < rows ? problem.bytes : problem.queries;
            target.push_back(static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0)));
        }
    }
    return problem;
}

void append_copies(std::span<const std::uint8_t> row, std::size_t count, int noise,
                   std::vector<std::uint8_t>& bytes) {
    const std::vector<std::uint8_t> copy(row.begin(), row.end());
    for (std::size_t i = 0; i < count; ++i) {
        Random random(3, i);
        for (const std::uint8_t value : copy) {
            const auto range = static_cast<std::uint32_t>(2 * noise + 1);
            const int moved = value + static_cast<int>(random.below(range)) - noise;
            bytes.push_back(static_cast<std::uint8_t>(std::clamp(moved, 0, 255)));
        }
    }
}

std::vector<RowMatch> found(const NeighborGraph& graph, const ByteRows& rows,
                            std::span<const std::uint8_t> query, std::size_t k,
                            std::size_t breadth) {
    SearchScratch scratch;
    const auto matches = search_graph(graph, rows, query, k, breadth, scratch);
    return {matches.begin(), matches.end()};
}

double recall(const NeighborGraph& graph, const Problem& problem, std::size_t k,
              std::size_t breadth) {
    SearchScratch scratch;
    std::size_t hits = 0;
    for (std::size_t q = 0; q < problem.query_count(); ++q) {
        const std::vector<RowMatch> truth = exact_nearest(problem.rows(), problem.query(q), k);
        const auto matches =
            search_graph(graph, problem.rows(), problem.query(q), k, breadth, scratch);
        for (const RowMatch& match : matches) {
            hits += std::count(truth.begin(), truth.end(), match) > 0 ? 1 : 0;
        }
    }
    return static_cast<double>(hits) / static_cast<double>(k * problem.query_count());
}

// Rows, first of their copies only, that no path leads to from the start.
std::size_t unreachable(const NeighborGraph& graph, std::size_t rows) {
    std::vector<bool> reached(rows, false);
    std::vector<std::uint32_t> queue = {graph.start};
    reached[graph.start] = true;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        for (std::size_t slot = 0; slot < graph.degree; ++slot) {
            const std::uint32_t link = graph.links[queue[i] * std::size_t{graph.degree} + slot];
            if (link == kNoIndex || reached[link]) continue;
            reached[link] = true;
            queue.push_back(link);
        }
    }
    return static_cast<std::size_t>(std::count(reached.begin(), reached.end(), false));
}

TEST(NeighborGraph, FindsNearlyAllThatBruteForceFinds) {
    const Problem problem = clustered(8'000, 150, 150);
    const NeighborGraph graph = build_neighbor_graph(problem.rows());
    check_graph(graph, problem.rows().size());
    EXPECT_EQ(unreachable(graph, problem.rows().size()), 0U);
    EXPECT_GE(recall(graph, problem, 10, 64), 0.99);
    EXPECT_GE(recall(graph, problem, 1, 64), 0.99);
}

TEST(NeighborGraph, FindsMoreTheBroaderTheSearch) {
    const Problem problem = clustered(6'000, 3, 100);
    const NeighborGraph graph = build_neighbor_graph(problem.rows(), {.degree = 9, .breadth = 16});
    const double narrow = recall(graph, problem, 10, 10);
    EXPECT_LT(narrow, 0.95);
    EXPECT_GT(recall(graph, problem, 10, 80), narrow);
    EXPECT_EQ(recall(graph, problem, 10, problem.rows().size()), 1.0);
}

TEST(NeighborGraph, FindsNearlyEveryRowByItself) {
    const Problem problem = clustered(3'000, 40, 0);
    const NeighborGraph graph = build_neighbor_graph(problem.rows());
    std::size_t missed = 0;
    SearchScratch scratch;
    for (std::uint32_t i = 0; i < problem.rows().size(); ++i) {
        const auto matches =
            search_graph(graph, problem.rows(), problem.rows().row(i), 1, 64, scratch);
        ASSERT_EQ(matches.size(), 1U);
        if (matches[0] != RowMatch{i, 0}) ++missed;
    }
    EXPECT_LE(missed, 3U);
}

TEST(NeighborGraph, IsTheSameForAnyNumberOfThreads) {
    Problem problem = clustered(3'000, 60, 0);
    append_copies(problem.rows().row(17), 100, 0, problem.bytes);
    append_copies(problem.rows().row(99), 100, 1, problem.bytes);
    set_thread_count(1);
    const NeighborGraph one = build_neighbor_graph(problem.rows());
    for (const int threads : {2, 4}) {
        set_thread_count(threads);
        const NeighborGraph several = build_neighbor_graph(problem.rows());
        EXPECT_EQ(several.start, one.start);
        EXPECT_EQ(several.links, one.links);
    }
    set_thread_count(0);
    const NeighborGraph other = build_neighbor_graph(problem.rows(), {.seed = 1});
    EXPECT_NE(other.links, one.links);
}

TEST(NeighborGraph, GivesCopiesInTheOrderOfTheirIndices) {
    Problem problem = clustered(2'000, 25, 50);
    const std::size_t original = 321;
    append_copies(problem.rows().row(original), 1000, 0, problem.bytes);
    const NeighborGraph graph = build_neighbor_graph(problem.rows());
    check_graph(graph, problem.rows().size());
    EXPECT_EQ(unreachable(graph, problem.rows().size()), 0U);
    const std::vector<RowMatch> copies =
        found(graph, problem.rows(), problem.rows().row(original), 1001, 1);
    ASSERT_EQ(copies.size(), 1001U);
    EXPECT_EQ(copies[0].row, original);
    for (std::uint32_t i = 1; i < copies.size(); ++i) EXPECT_EQ(copies[i].row, 1999 + i);
    EXPECT_GE(recall(graph, problem, 10, 64), 0.99);
}

TEST(NeighborGraph, StaysConnectedAmongThousandsOfNearCopies) {
    Problem problem = clustered(2'000, 25, 50);
    append_copies(problem.rows().row(5), 1500, 1, problem.bytes);
    append_copies(problem.rows().row(1'234), 1500, 0, problem.bytes);
    const std::size_t rows = problem.rows().size();
    for (const int degree : {4, 8, 32}) {
        const NeighborGraph graph = build_neighbor_graph(problem.rows(), {.degree = degree});
        check_graph(graph, rows);
        EXPECT_EQ(unreachable(graph, rows), 0U);
        for (std::size_t i = 0; i < rows; i += 97) {
            const auto nearest = found(graph, problem.rows(), problem.rows().row(i), 1, rows);
            EXPECT_EQ(nearest, exact_nearest(problem.rows(), problem.rows().row(i), 1));
        }
        if (degree == 32) {
            EXPECT_GE(recall(graph, problem, 10, 64), 0.99);
        }
    }
}

TEST(NeighborGraph, OfEqualRowsFindsThemAll) {
    Problem problem;
    problem.bytes.assign(300 * kLength, 7);
    problem.queries.assign(kLength, 9);
    const NeighborGraph graph = build_neighbor_graph(problem.rows());
    check_graph(graph, 300);
    EXPECT_EQ(found(graph, problem.rows(), problem.query(0), 20, 20),
              exact_nearest(problem.rows(), problem.query(0), 20));
    EXPECT_EQ(found(graph, problem.rows(), problem.query(0), 500, 1).size(), 300U);
}

TEST(NeighborGraph, OfFewRowsFindsThemAll) {
    for (const std::size_t rows : {1U, 2U, 3U, 10U, 33U}) {
        const Problem problem = clustered(rows, 1, 1);
        const NeighborGraph graph = build_neighbor_graph(problem.rows());
        check_graph(graph, rows);
        EXPECT_EQ(found(graph, problem.rows(), problem.query(0), 100, 1),
                  exact_nearest(problem.rows(), problem.query(0), 100));
        EXPECT_TRUE(found(graph, problem.rows(), problem.query(0), 0, 10).empty());
    }
}

TEST(NeighborGraph, OfNoRowsFindsNothing) {
    const ByteRows rows{{}, kLength};
    const NeighborGraph graph = build_neighbor_graph(rows);
    check_graph(graph, 0);
    const std::vector<std::uint8_t> query(kLength, 1);
    EXPECT_TRUE(found(graph, rows, query, 10, 10).empty());
}

TEST(NeighborGraph, SearchesAlikeWithAUsedScratch) {
    const Problem problem = clustered(1'000, 10, 300);
    const Problem smaller = clustered(400, 10, 0);
    const NeighborGraph graph = build_neighbor_graph(problem.rows());
    const NeighborGraph other = build_neighbor_graph(smaller.rows(), {.degree = 16});
    SearchScratch used;
    // More searches than an epoch can number, and another graph in between.
    for (std::size_t q = 0; q < problem.query_count(); ++q) {
        const auto again = search_graph(graph, problem.rows(), problem.query(q), 5, 20, used);
        EXPECT_EQ(std::vector<RowMatch>(again.begin(), again.end()),
                  found(graph, problem.rows(), problem.query(q), 5, 20));
        if (q == 20) search_graph(other, smaller.rows(), problem.query(q), 5, 20, used);
    }
}

TEST(BuildNeighborGraph, RejectsSettingsOutOfRange) {
    const Problem problem = clustered(10, 1, 0);
    for (const NeighborGraphSettings& settings :
         {NeighborGraphSettings{.degree = 3}, NeighborGraphSettings{.degree = 257},
          NeighborGraphSettings{.alpha = 0.9}, NeighborGraphSettings{.breadth = 0}}) {
        EXPECT_THROW(build_neighbor_graph(problem.rows(), settings), InvalidInput);
    }
    EXPECT_THROW(build_neighbor_graph({problem.bytes, 7}), InvalidInput);
}

TEST(CheckGraph, RejectsDamage) {
    const Problem problem = clustered(50, 2, 0);
    const NeighborGraph intact = build_neighbor_graph(problem.rows());
    check_graph(intact, 50);
    EXPECT_THROW(check_graph(intact, 49), InvalidInput);
    EXPECT_THROW(check_graph(intact, 0), InvalidInput);
    EXPECT_THROW(check_graph({}, 0), InvalidInput);
    NeighborGraph graph = intact;
    graph.start = 50;
    EXPECT_THROW(check_graph(graph, 50), InvalidInput);
    graph.start = kNoIndex;
    EXPECT_THROW(check_graph(graph, 50), InvalidInput);
    graph = intact;
    graph.links.pop_back();
    EXPECT_THROW(check_graph(graph, 50), InvalidInput);
    graph = intact;
    graph.degree = 25;
    EXPECT_THROW(check_graph(graph, 50), InvalidInput);
    for (const std::size_t slot : {std::size_t{0}, intact.links.size() - 1}) {
        graph = intact;
        graph.links[slot] = 50;
        EXPECT_THROW(check_graph(graph, 50), InvalidInput);
    }
}

TEST(CheckGraph, RejectsCopiesThatRunInCircles) {
    const Problem problem = clustered(50, 2, 0);
    NeighborGraph graph = build_neighbor_graph(problem.rows());
    const auto copy_of = [&](std::size_t row) -> std::uint32_t& {
        return graph.links[(row + 1) * graph.degree - 1];
    };
    copy_of(3) = 9;
    EXPECT_NO_THROW(check_graph(graph, 50));
    copy_of(9) = 3;
    EXPECT_THROW(check_graph(graph, 50), InvalidInput);
    copy_of(9) = 9;
    EXPECT_THROW(check_graph(graph, 50), InvalidInput);
}

TEST(CheckGraph, LetsThroughOnlyWhatCanBeSearched) {
    const Problem problem = clustered(200, 2, 1);
    Random random(7);
    for (int trial = 0; trial < 200; ++trial) {
        NeighborGraph graph = build_neighbor_graph(problem.rows(), {.degree = 4});
        for (int change = 0; change < 100; ++change) {
            graph.links[random.below(800)] = random.below(4) == 0 ? kNoIndex : random.below(200);
        }
        try {
            check_graph(graph, 200);
        } catch (const InvalidInput&) {
            for (std::size_t row = 0; row < 200; ++row) graph.links[row * 4 + 3] = kNoIndex;
            check_graph(graph, 200);
        }
        const auto matches = found(graph, problem.rows(), problem.query(0), 10, 10);
        for (const RowMatch& match : matches) EXPECT_LT(match.row, 200U);
    }
}

}  // namespace
}  // namespace ostraka
