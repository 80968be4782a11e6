// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

// A candidate that explains the cells from `first` to `last`.
Verified candidate(double confidence, std::uint32_t first, std::uint32_t last) {
    Verified v;
    v.confidence = confidence;
    v.cells.resize(last - first);
    std::iota(v.cells.begin(), v.cells.end(), first);
    v.support = v.cells.size();
    return v;
}

std::vector<std::size_t> chosen_of(const std::vector<Verified>& candidates, double min_confidence) {
    std::vector<const Verified*> pointers;
    for (const Verified& v : candidates) pointers.push_back(&v);
    return choose(pointers, min_confidence);
}

TEST(Choose, KeepsTheBestOfThoseThatExplainTheSame) {
    const auto chosen = chosen_of({candidate(0.7, 0, 100), candidate(0.9, 10, 110),
                                   candidate(0.8, 500, 600), candidate(0.6, 520, 640)},
                                  0.5);
    EXPECT_EQ(chosen, (std::vector<std::size_t>{1, 2}));
}

TEST(Choose, ToleratesALittleOverlap) {
    const auto chosen = chosen_of({candidate(0.9, 0, 100), candidate(0.8, 80, 180)}, 0.5);
    EXPECT_EQ(chosen.size(), 2U);
}

TEST(Choose, OverlapsAddUp) {
    const auto chosen = chosen_of({candidate(0.9, 0, 100), candidate(0.8, 200, 300),
                                   candidate(0.7, 80, 220)},  // 20 and 20 of 140
                                  0.5);
    EXPECT_EQ(chosen.size(), 3U);
    const auto fewer = chosen_of({candidate(0.9, 0, 100), candidate(0.8, 200, 300),
                                  candidate(0.7, 60, 240)},  // 40 and 40 of 180
                                 0.5);
    EXPECT_EQ(fewer.size(), 2U);
}

TEST(Choose, LeavesOutWhatIsBelowTheThreshold) {
    EXPECT_TRUE(chosen_of({candidate(0.49, 0, 100)}, 0.5).empty());
    EXPECT_EQ(chosen_of({candidate(0.5, 0, 100)}, 0.5).size(), 1U);
    EXPECT_TRUE(chosen_of({}, 0.5).empty());
}

TEST(Choose, OfPosesOfOneModelAtOnePlaceTheOneWhoseDepthsFitBest) {
    Verified surer = candidate(0.91, 0, 100);
    Verified finer = candidate(0.90, 2, 102);
    surer.depth_fit = 90.0;
    finer.depth_fit = 93.0;
    EXPECT_EQ(chosen_of({surer, finer}, 0.5), (std::vector<std::size_t>{1}));
    // Another model, another place, or one that explains much less: confidence decides.
    Verified other_model = finer;
    other_model.hypothesis.model = 7;
    EXPECT_EQ(chosen_of({surer, other_model}, 0.5), (std::vector<std::size_t>{0}));
    Verified beside = candidate(0.90, 50, 150);
    beside.depth_fit = 93.0;
    EXPECT_EQ(chosen_of({surer, beside}, 0.5), (std::vector<std::size_t>{0}));
    Verified doubtful = finer;
    doubtful.confidence = 0.6;
    EXPECT_EQ(chosen_of({surer, doubtful}, 0.5), (std::vector<std::size_t>{0}));
}

class RivalsOfTheFirst : public ::testing::Test {
  protected:
    std::vector<Verified> candidates_ = {candidate(0.99, 0, 100), candidate(0.9, 0, 100),
                                         candidate(0.8, 20, 120), candidate(0.999, 70, 170)};
    Rivals rivals() const {
        std::vector<const Verified*> pointers;
        for (const Verified& v : candidates_) pointers.push_back(&v);
        return rivals_of(candidates_[0], pointers);
    }
};

TEST_F(RivalsOfTheFirst, AreNotPosesOfItsOwnModel) {
    EXPECT_EQ(rivals().odds, 0.0);
    EXPECT_EQ(rivals_of(candidates_[0], {}).odds, 0.0);
}

TEST_F(RivalsOfTheFirst, AreTheOtherModelsThatExplainTheSameAddedUp) {
    candidates_[1].hypothesis.model = 1;
    candidates_[3].hypothesis.model = 3;  // shares too little
    EXPECT_NEAR(rivals().odds, 9.0, 1e-9);
    EXPECT_EQ(rivals().likeliest, 1U);
    candidates_[2].hypothesis.model = 2;
    EXPECT_NEAR(rivals().odds, 9.0 + 4.0, 1e-9);
    EXPECT_EQ(rivals().likeliest, 1U);
    candidates_[2].hypothesis.model = 1;  // two poses of one model: the better one
    EXPECT_NEAR(rivals().odds, 9.0, 1e-9);
}

TEST_F(RivalsOfTheFirst, CountHardlyWhereTheyLeaveMuchUnexplained) {
    candidates_[1] = candidate(0.9, 0, 95);
    candidates_[1].hypothesis.model = 1;
    EXPECT_NEAR(rivals().odds, 9.0 * std::exp(-1.0), 1e-9);
    candidates_[1] = candidate(0.9, 0, 50);
    candidates_[1].hypothesis.model = 1;
    EXPECT_LT(rivals().odds, 0.001);
}

TEST_F(RivalsOfTheFirst, HaveFiniteOddsHoweverSureTheyAre) {
    candidates_[1].confidence = 1.0;
    candidates_[1].hypothesis.model = 1;
    EXPECT_TRUE(std::isfinite(rivals().odds));
}

// The value that choose() maximizes, of a set without conflicts; -1 of others.
double value_of_set(const std::vector<Verified>& candidates, unsigned set) {
    double value = 0.0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if ((set >> i & 1U) == 0U) continue;
        const Verified& a = candidates[i];
        value -= std::log(1.0 - a.confidence) * static_cast<double>(a.support);
        for (std::size_t j = 0; j < i; ++j) {
            if ((set >> j & 1U) == 0U) continue;
            const Verified& b = candidates[j];
            std::vector<std::uint32_t> shared;
            std::set_intersection(a.cells.begin(), a.cells.end(), b.cells.begin(), b.cells.end(),
                                  std::back_inserter(shared));
            const std::size_t smaller = std::min(a.support, b.support);
            if (static_cast<double>(shared.size()) > 0.35 * static_cast<double>(smaller)) return -1;
        }
    }
    return value;
}

TEST(Choose, IsTheBestOfAllSets) {
    Random random(4);
    for (int trial = 0; trial < 60; ++trial) {
        std::vector<Verified> candidates;
        for (int i = 0; i < 10; ++i) {
            const std::uint32_t first = random.below(400);
            candidates.push_back(
                candidate(random.uniform(0.5, 0.999), first, first + 20 + random.below(150)));
        }
        double best = 0.0;
        for (unsigned set = 0; set < 1024; ++set) {
            best = std::max(best, value_of_set(candidates, set));
        }
        unsigned chosen = 0;
        for (const std::size_t i : chosen_of(candidates, 0.5)) chosen |= 1U << i;
        EXPECT_NEAR(value_of_set(candidates, chosen), best, 1e-9);
    }
}

TEST(Choose, ManySmallWrongOnesDontOutweighALargeRightOne) {
    std::vector<Verified> candidates = {candidate(0.999999, 0, 3000)};
    for (std::uint32_t i = 0; i < 4; ++i)
        candidates.push_back(candidate(0.9, 600 * i, 600 * i + 500));
    EXPECT_EQ(chosen_of(candidates, 0.5), (std::vector<std::size_t>{0}));
}

TEST(Choose, OfTwoThatAreSureTheWholeNotThePart) {
    const auto chosen = chosen_of({candidate(0.9997, 0, 4300), candidate(0.9992, 0, 4700)}, 0.5);
    EXPECT_EQ(chosen, (std::vector<std::size_t>{1}));
}

TEST(Choose, TwoHalvesDontOutweighTheWholeForBeingTwo) {
    const std::vector<Verified> candidates = {candidate(0.999, 0, 1000), candidate(0.995, 0, 450),
                                              candidate(0.995, 500, 950)};
    EXPECT_EQ(chosen_of(candidates, 0.5), (std::vector<std::size_t>{0}));
}

}  // namespace
}  // namespace ostraka
