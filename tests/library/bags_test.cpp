// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/bags.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/library/retrieval.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

const ModelLibrary& library() {
    static const ModelLibrary built = [] {
        ModelLibrary library = build_library(testing::simple_models(), testing::quick_settings());
        make_bags(library);
        return library;
    }();
    return built;
}

PreparedSegment segment_of(std::size_t entry) {
    PreparedSegment segment;
    segment.whole = library().entries[entry].cloud;
    segment.whole.normals =
        estimate_normals_within(segment.whole, kNormalRadius * library().settings.sampling);
    segment.whole = remove_invalid(segment.whole);
    segment.piece = segment.whole;
    return segment;
}

TEST(MakeBags, EveryEntryHasSharesOfTheWords) {
    const std::size_t words = library().codebook.size();
    ASSERT_GT(words, 50U);
    ASSERT_LE(words, 128U);
    EXPECT_EQ(library().codebook.length, kShotLength);
    ASSERT_EQ(library().bags.size(), library().entries.size() * words);
    for (std::size_t i = 0; i < library().entries.size(); ++i) {
        const auto bag = library().bags.begin() + static_cast<std::ptrdiff_t>(i * words);
        EXPECT_NEAR(std::accumulate(bag, bag + static_cast<std::ptrdiff_t>(words), 0.0), 1.0, 1e-5);
    }
}

TEST(MakeBags, AgainGivesTheSame) {
    ModelLibrary again = library();
    make_bags(again);
    EXPECT_EQ(again.codebook.words, library().codebook.words);
    EXPECT_EQ(again.bags, library().bags);
}

TEST(MakeBags, WithoutKeypointsThereIsNoCodebook) {
    ModelLibrary bare = library();
    for (Model& model : bare.models) model.keypoints = {};
    make_bags(bare);
    EXPECT_EQ(bare.codebook.size(), 0U);
    EXPECT_TRUE(bare.bags.empty());
    const EntryIndex index(bare);
    EXPECT_THROW(classify(index, segment_of(0), kBagOfWords), InvalidInput);
    EXPECT_FALSE(classify(index, segment_of(0), "vfh").empty());
}

TEST(BagDistances, AreTheDefinition) {
    const EntryIndex index(library());
    const PreparedSegment segment = segment_of(3);
    const std::vector<float> bag = describe_bag(segment.piece, library(), kSegmentBagKeypoints);
    const std::vector<float> distances = index.bag_distances(segment.piece);
    ASSERT_EQ(distances.size(), library().entries.size());
    for (std::size_t i = 0; i < distances.size(); ++i) {
        double likeness = 0.0;  // Bhattacharyya's: |sqrt a - sqrt b|^2 = 2 - 2 sum sqrt(a b)
        for (std::size_t w = 0; w < bag.size(); ++w) {
            likeness += std::sqrt(double{bag[w]} * double{library().bags[i * bag.size() + w]});
        }
        EXPECT_NEAR(distances[i], std::sqrt(std::max(0.0, 2.0 - 2.0 * likeness)), 2e-3);
    }
}

TEST(Classify, AnEntrysOwnCloudIsItsModelByItsWords) {
    const EntryIndex index(library());
    std::size_t right = 0;
    for (std::size_t i = 0; i < library().entries.size(); ++i) {
        const auto ranking = classify(index, segment_of(i), kBagOfWords);
        ASSERT_EQ(ranking.size(), library().models.size());
        if (ranking.front().model == library().entries[i].model) ++right;
    }
    EXPECT_GE(right, library().entries.size() * 95 / 100);
}

}  // namespace
}  // namespace ostraka
