// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/selection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

ElementSet range_set(std::size_t first, std::size_t last) {
    ElementSet set{};
    for (std::size_t i = first; i < last; ++i) set[i / 64] |= std::uint64_t{1} << (i % 64);
    return set;
}

std::vector<ElementSet> random_sets(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<ElementSet> sets;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t first = random.below(800);
        sets.push_back(range_set(first, first + 20 + random.below(200)));
    }
    return sets;
}

double objective(std::span<const ElementSet> candidates, const std::vector<std::uint32_t>& chosen) {
    double sum = 0.0;
    for (const ElementSet& observation : candidates) {
        double best = 0.0;
        for (const std::uint32_t c : chosen)
            best = std::max(best, overlap(candidates[c], observation));
        sum += best;
    }
    return sum;
}

// Plain greedy, every gain worked out anew.
std::vector<std::uint32_t> greedy(std::span<const ElementSet> candidates, std::size_t budget) {
    std::vector<std::uint32_t> chosen;
    while (chosen.size() < budget) {
        double best = -1.0;
        std::uint32_t next = 0;
        for (std::uint32_t c = 0; c < candidates.size(); ++c) {
            std::vector<std::uint32_t> with = chosen;
            with.push_back(c);
            const double value = objective(candidates, with);
            if (value > best + 1e-9) {
                best = value;
                next = c;
            }
        }
        chosen.push_back(next);
    }
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

TEST(Overlap, IsIntersectionOverUnion) {
    EXPECT_DOUBLE_EQ(overlap(range_set(0, 100), range_set(50, 150)), 50.0 / 150.0);
    EXPECT_DOUBLE_EQ(overlap(range_set(0, 100), range_set(0, 100)), 1.0);
    EXPECT_DOUBLE_EQ(overlap(range_set(0, 100), range_set(500, 600)), 0.0);
    EXPECT_DOUBLE_EQ(overlap(ElementSet{}, ElementSet{}), 0.0);
}

TEST(SelectEntries, LazyGreedyChoosesWhatPlainGreedyDoes) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const auto sets = random_sets(40, seed);
        const SelectionResult result = select_entries(sets, {.budget = 6, .max_overlap = 2.0});
        EXPECT_NEAR(objective(sets, result.chosen), objective(sets, greedy(sets, 6)), 1e-4);
        EXPECT_NEAR(result.coverage, objective(sets, result.chosen) / 40.0, 1e-6);
    }
}

TEST(SelectEntries, ReachesItsGuaranteeAgainstTheBestOfAllChoices) {
    const auto sets = random_sets(14, 7);
    double best = 0.0;
    for (std::uint32_t mask = 0; mask < (1U << 14U); ++mask) {
        if (std::popcount(mask) != 3) continue;
        std::vector<std::uint32_t> chosen;
        for (std::uint32_t c = 0; c < 14; ++c) {
            if ((mask >> c & 1U) != 0) chosen.push_back(c);
        }
        best = std::max(best, objective(sets, chosen));
    }
    const SelectionResult result = select_entries(sets, {.budget = 3, .max_overlap = 2.0});
    EXPECT_GE(objective(sets, result.chosen), (1.0 - std::exp(-1.0)) * best);
}

TEST(SelectEntries, DropsWhatShowsTheSameSurface) {
    const std::vector<ElementSet> sets = {range_set(0, 100), range_set(0, 99), range_set(300, 400),
                                          range_set(301, 400)};
    const SelectionResult result = select_entries(sets, {.budget = 10, .max_overlap = 0.9});
    EXPECT_EQ(result.chosen, (std::vector<std::uint32_t>{0, 2}));
    EXPECT_EQ(result.redundant, 2U);
    EXPECT_EQ(result.beyond_budget, 0U);
}

TEST(SelectEntries, CountsAddUp) {
    const auto sets = random_sets(100, 3);
    const SelectionResult result = select_entries(sets, {.budget = 12, .max_overlap = 0.8});
    EXPECT_EQ(result.chosen.size(), 12U);
    EXPECT_EQ(result.chosen.size() + result.redundant + result.beyond_budget, 100U);
    EXPECT_TRUE(std::is_sorted(result.chosen.begin(), result.chosen.end()));
}

TEST(SelectEntries, NothingFromNothing) {
    EXPECT_TRUE(select_entries({}, {}).chosen.empty());
}

TEST(SelectEntries, EveryKeptCandidateKnowsWhoShowsMostOfIt) {
    const auto sets = random_sets(60, 11);
    const SelectionResult result = select_entries(sets, {.budget = 8});
    ASSERT_EQ(result.nearest.size(), sets.size());
    std::size_t redundant = 0;
    for (std::uint32_t i = 0; i < sets.size(); ++i) {
        if (result.nearest[i] == kNoIndex) {
            ++redundant;
            continue;
        }
        const double own = overlap(sets[i], sets[result.chosen[result.nearest[i]]]);
        for (const std::uint32_t c : result.chosen)
            EXPECT_LE(overlap(sets[i], sets[c]), own + 1e-6);
    }
    EXPECT_EQ(redundant, result.redundant);
    for (std::uint32_t c = 0; c < result.chosen.size(); ++c) {
        EXPECT_EQ(result.nearest[result.chosen[c]], c);
    }
}

TEST(SelectEntries, CoverageIsReportedByOverlap) {
    const auto sets = random_sets(40, 3);
    const SelectionResult all = select_entries(sets, {.budget = 40, .max_overlap = 2.0});
    for (const double share : all.covered) EXPECT_DOUBLE_EQ(share, 1.0);
    const SelectionResult few = select_entries(sets, {.budget = 4, .max_overlap = 2.0});
    for (std::size_t level = 0; level < few.covered.size(); ++level) {
        int covered = 0;
        for (const ElementSet& set : sets) {
            double best = 0.0;
            for (const std::uint32_t c : few.chosen) best = std::max(best, overlap(set, sets[c]));
            covered += best >= kCoveredOverlaps[level] - 1e-7 ? 1 : 0;
        }
        EXPECT_NEAR(few.covered[level], covered / 40.0, 1e-9);
    }
}

// Two halves of a surface that a half turn exchanges.
TEST(SelectEntries, WhatASymmetryExchangesIsRedundant) {
    ElementMap half_turn(kSurfaceElements);
    for (std::uint32_t i = 0; i < kSurfaceElements; ++i) {
        half_turn[i] = (i + kSurfaceElements / 2) % kSurfaceElements;
    }
    const std::vector<ElementMap> images = {half_turn};
    const std::vector<ElementSet> sets = {range_set(0, 100), range_set(512, 612),
                                          range_set(200, 300), range_set(712, 812)};
    EXPECT_EQ(mapped(sets[0], half_turn), sets[1]);
    EXPECT_EQ(select_entries(sets, {.budget = 4}).chosen.size(), 4U);
    const SelectionResult result = select_entries(sets, {.budget = 4}, images);
    EXPECT_EQ(result.chosen, (std::vector<std::uint32_t>{0, 2}));
    EXPECT_DOUBLE_EQ(result.coverage, 1.0);
}

TEST(ThinOut, SpreadsEvenly) {
    EXPECT_EQ(thin_out(10, 5), (std::vector<std::uint32_t>{0, 2, 4, 6, 8}));
    EXPECT_EQ(thin_out(3, 0).size(), 3U);
    EXPECT_EQ(thin_out(3, 7).size(), 3U);
    EXPECT_TRUE(thin_out(0, 4).empty());
}

}  // namespace
}  // namespace ostraka
