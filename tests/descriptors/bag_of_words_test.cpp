// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/bag_of_words.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kLength = 37;  // no multiple of any vector's width
constexpr std::size_t kGroups = 7;

// Rows of group g have nearly all their weight in bins 5 g to 5 g + 2, and are of different scales.
std::vector<float> grouped_rows(std::size_t each) {
    Random random(5);
    std::vector<float> rows;
    for (std::size_t i = 0; i < kGroups * each; ++i) {
        const std::size_t first = 5 * (i % kGroups);
        const double scale = random.uniform(0.1, 9.0);
        for (std::size_t j = 0; j < kLength; ++j) {
            const bool inside = j >= first && j < first + 3;
            rows.push_back(static_cast<float>(
                scale * (inside ? random.uniform(3.0, 4.0) : random.uniform(0.0, 0.01))));
        }
    }
    return rows;
}

std::vector<float> random_rows(std::size_t count) {
    Random random(9);
    std::vector<float> rows(count * kLength);
    for (float& value : rows) value = static_cast<float>(random.uniform(-1.0, 3.0));
    return rows;
}

std::vector<float> row_of(std::span<const float> rows, std::size_t i) {
    const auto row = rows.subspan(i * kLength, kLength);
    return {row.begin(), row.end()};
}

// The row that is rooted to this word.
std::vector<float> squared(std::vector<float> word) {
    for (float& value : word) value *= std::abs(value);
    return word;
}

TEST(LearnCodebook, FindsSeparateGroups) {
    const std::vector<float> rows = grouped_rows(30);
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const Codebook codebook = learn_codebook(rows, kLength, {.words = kGroups, .seed = seed});
        ASSERT_EQ(codebook.size(), kGroups);
        std::set<std::size_t> found;
        for (std::size_t w = 0; w < kGroups; ++w) {
            const std::vector<float> word = row_of(codebook.words, w);
            double norm = 0.0;
            for (const float value : word) norm += double{value} * double{value};
            EXPECT_NEAR(norm, 1.0, 1e-6);
            const auto peak = std::max_element(word.begin(), word.end()) - word.begin();
            found.insert(static_cast<std::size_t>(peak) / 5);
        }
        EXPECT_EQ(found.size(), kGroups) << "two words share a group, seed " << seed;
        for (const float share : bag_of_words(rows, codebook)) {
            EXPECT_FLOAT_EQ(share, 1.0F / static_cast<float>(kGroups));
        }
    }
}

TEST(LearnCodebook, AWordIsTheRootOfItsOnlyRow) {
    std::vector<float> row(kLength, 0.0F);
    row[3] = 9.0F;
    row[8] = -16.0F;
    const Codebook codebook = learn_codebook(row, kLength);
    ASSERT_EQ(codebook.size(), 1U);
    EXPECT_FLOAT_EQ(codebook.words[3], 0.6F);
    EXPECT_FLOAT_EQ(codebook.words[8], -0.8F);
    EXPECT_EQ(codebook.words[0], 0.0F);
}

TEST(LearnCodebook, FewRowsGiveAWordEach) {
    std::vector<float> rows = grouped_rows(1);
    const std::vector<float> once = rows;
    for (int copy = 0; copy < 2; ++copy) rows.insert(rows.end(), once.begin(), once.end());
    const Codebook codebook = learn_codebook(rows, kLength, {.words = 50});
    EXPECT_EQ(codebook.size(), kGroups);
    for (const float share : bag_of_words(rows, codebook)) {
        EXPECT_FLOAT_EQ(share, 1.0F / static_cast<float>(kGroups));
    }
}

TEST(LearnCodebook, ThreadsDoNotMatterAndSeedsDo) {
    const std::vector<float> rows = random_rows(1500);
    const CodebookSettings settings{.words = 40, .max_samples = 1000};
    set_thread_count(1);
    const Codebook one = learn_codebook(rows, kLength, settings);
    const std::vector<float> one_bag = bag_of_words(rows, one);
    set_thread_count(4);
    EXPECT_EQ(learn_codebook(rows, kLength, settings).words, one.words);
    EXPECT_EQ(bag_of_words(rows, one), one_bag);
    set_thread_count(0);
    EXPECT_NE(learn_codebook(rows, kLength, {.words = 40, .max_samples = 1000, .seed = 1}).words,
              one.words);
}

TEST(LearnCodebook, IterationsBringWordsNearerToTheRows) {
    const std::vector<float> rows = random_rows(800);
    const auto likeness = [&](int iterations) {
        const Codebook codebook =
            learn_codebook(rows, kLength, {.words = 20, .iterations = iterations});
        double sum = 0.0;
        for (std::size_t i = 0; i < 800; ++i) {
            const std::vector<float> row = row_of(rows, i);
            double total = 0.0;
            for (const float value : row) total += std::abs(double{value});
            double best = -1.0;
            for (std::size_t w = 0; w < codebook.size(); ++w) {
                double cosine = 0.0;
                for (std::size_t j = 0; j < kLength; ++j) {
                    cosine += std::copysign(std::sqrt(std::abs(double{row[j]}) / total), row[j]) *
                              double{codebook.words[w * kLength + j]};
                }
                best = std::max(best, cosine);
            }
            sum += best;
        }
        return sum / 800.0;
    };
    EXPECT_GT(likeness(10), likeness(1) + 1e-4);
}

TEST(BagOfWords, AWordsOwnRowFallsIntoItsOwnBin) {
    const Codebook codebook = learn_codebook(random_rows(600), kLength, {.words = 30});
    ASSERT_EQ(codebook.size(), 30U);
    for (std::size_t w = 0; w < codebook.size(); ++w) {
        const std::vector<float> bag = bag_of_words(squared(row_of(codebook.words, w)), codebook);
        EXPECT_EQ(bag[w], 1.0F) << w;
    }
}

TEST(BagOfWords, CountsShares) {
    const std::vector<float> rows = grouped_rows(1);
    const Codebook codebook = learn_codebook(rows, kLength, {.words = kGroups});
    std::vector<float> piece = row_of(rows, 2);
    for (const std::size_t i : {4U, 2U, 2U}) {
        const std::vector<float> row = row_of(rows, i);
        piece.insert(piece.end(), row.begin(), row.end());
    }
    std::vector<float> bag = bag_of_words(piece, codebook);
    piece.insert(piece.end(), kLength, 0.0F);
    EXPECT_EQ(bag_of_words(piece, codebook), bag) << "a row of 0 counted";
    std::sort(bag.begin(), bag.end());
    EXPECT_EQ(bag[kGroups - 1], 0.75F);
    EXPECT_EQ(bag[kGroups - 2], 0.25F);
    EXPECT_EQ(bag[kGroups - 3], 0.0F);
}

TEST(BagOfWords, OrderAndScaleOfRowsDoNotMatter) {
    const std::vector<float> rows = random_rows(300);
    const Codebook codebook = learn_codebook(rows, kLength, {.words = 25});
    std::vector<float> turned;
    for (std::size_t i = 300; i-- > 0;) {
        for (const float value : row_of(rows, i)) turned.push_back(4.0F * value);
    }
    const std::vector<float> bag = bag_of_words(rows, codebook);
    EXPECT_EQ(bag_of_words(turned, codebook), bag);
    EXPECT_NEAR(std::accumulate(bag.begin(), bag.end(), 0.0), 1.0, 1e-6);
}

TEST(BagOfWords, NoRowsGiveZeros) {
    const Codebook codebook = learn_codebook(grouped_rows(1), kLength, {.words = 3});
    EXPECT_EQ(bag_of_words({}, codebook), std::vector<float>(3, 0.0F));
    EXPECT_EQ(bag_of_words(std::vector<float>(2 * kLength, 0.0F), codebook),
              std::vector<float>(3, 0.0F));
}

TEST(BagOfWords, RefusesWhatItCannotUse) {
    const std::vector<float> rows = grouped_rows(2);
    const Codebook codebook = learn_codebook(rows, kLength);
    std::vector<float> damaged = rows;
    damaged[40] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(learn_codebook({}, kLength), InvalidInput);
    EXPECT_THROW(learn_codebook(std::vector<float>(kLength, 0.0F), kLength), InvalidInput);
    EXPECT_THROW(learn_codebook(rows, 0), InvalidInput);
    EXPECT_THROW(learn_codebook(rows, kLength + 1), InvalidInput);
    EXPECT_THROW(learn_codebook(damaged, kLength), InvalidInput);
    EXPECT_THROW(learn_codebook(rows, kLength, {.words = 0}), InvalidInput);
    EXPECT_THROW(learn_codebook(rows, kLength, {.iterations = 0}), InvalidInput);
    EXPECT_THROW(learn_codebook(rows, kLength, {.max_samples = 0}), InvalidInput);
    EXPECT_THROW(bag_of_words(damaged, codebook), InvalidInput);
    EXPECT_THROW(bag_of_words(std::span(rows).first(kLength - 1), codebook), InvalidInput);
    EXPECT_THROW(bag_of_words(rows, {}), InvalidInput);
    EXPECT_THROW(bag_of_words(rows, {kLength, {}}), InvalidInput);
    EXPECT_THROW(bag_of_words(rows, {kLength, std::vector<float>(kLength + 1, 1.0F)}),
                 InvalidInput);
    EXPECT_THROW(bag_of_words(rows, {kLength, std::vector<float>(damaged.begin() + 37,
                                                                 damaged.begin() + 74)}),
                 InvalidInput);
}

TEST(BagOfWords, ExtremeValuesGiveNoNaN) {
    std::vector<float> rows = grouped_rows(3);
    for (std::size_t j = 0; j < kLength; ++j) {
        rows[j] = std::numeric_limits<float>::max();
        rows[kLength + j] = std::numeric_limits<float>::denorm_min();
    }
    const Codebook codebook = learn_codebook(rows, kLength, {.words = 9});
    for (const float value : codebook.words) ASSERT_TRUE(std::isfinite(value));
    for (const float value : bag_of_words(rows, codebook)) ASSERT_TRUE(std::isfinite(value));
}

}  // namespace
}  // namespace ostraka
