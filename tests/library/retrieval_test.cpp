// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/retrieval.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/normals.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

const ModelLibrary& shared_library() {
    static const ModelLibrary library =
        build_library(testing::simple_models(), testing::quick_settings());
    return library;
}

// A library whose entries have no spread, so that rows are compared with rows.
const ModelLibrary& library_of_rows() {
    static const ModelLibrary library = [] {
        LibrarySettings settings = testing::quick_settings();
        settings.selection.spread = 0;
        return build_library(testing::simple_models(), settings);
    }();
    return library;
}

TEST(EntryIndex, AnEntrysOwnRowIsNearestToIt) {
    const ModelLibrary& library = library_of_rows();
    const EntryIndex index(library);
    for (std::size_t t = 0; t < library.tables.size(); ++t) {
        const std::size_t length = descriptor_length(library.tables[t].descriptor);
        for (std::size_t i = 0; i < library.entries.size(); i += 7) {
            const auto row =
                std::span<const float>(library.tables[t].rows).subspan(i * length, length);
            EXPECT_EQ(index.distances(t, row)[i], 0.0F);
        }
    }
}

TEST(EntryIndex, ScalingARowChangesNothing) {
    const ModelLibrary& library = shared_library();
    const EntryIndex index(library);
    std::vector<float> row(library.tables[0].rows.begin(), library.tables[0].rows.begin() + 308);
    const auto before = index.distances(0, row);
    for (float& value : row) value *= 8.0F;
    EXPECT_EQ(index.distances(0, row), before);
}

TEST(NearestEntries, AgreesWithSorting) {
    const std::vector<float> distances = {3.0F, 1.0F, 2.0F, 1.0F, 0.5F};
    const auto nearest = nearest_entries(distances, 4);
    ASSERT_EQ(nearest.size(), 4U);
    EXPECT_EQ(nearest[0].entry, 4U);
    EXPECT_EQ(nearest[1].entry, 1U);  // ties by index
    EXPECT_EQ(nearest[2].entry, 3U);
    EXPECT_EQ(nearest[3].entry, 2U);
    EXPECT_EQ(nearest_entries(distances, 99).size(), 5U);
}

TEST(RankModels, VotesDecideThenTheNearestEntry) {
    ModelLibrary library;
    library.models.resize(3);
    for (const std::uint32_t model : {0U, 0U, 1U, 1U, 2U})
        library.entries.push_back({.model = model});
    const std::vector<float> distances = {0.2F, 0.9F, 0.3F, 0.4F, 0.8F};
    const auto k1 = rank_models(library, distances, 1);
    EXPECT_EQ(k1[0].model, 0U);
    EXPECT_EQ(k1[0].score, 1.0);
    EXPECT_EQ(k1[1].model, 1U);
    const auto k3 = rank_models(library, distances, 3);
    EXPECT_EQ(k3[0].model, 1U);
    EXPECT_EQ(k3[0].votes, 2);
    EXPECT_EQ(k3[0].best.entry, 2U);
    EXPECT_EQ(k3[2].model, 2U);
    EXPECT_EQ(k3[2].votes, 0);
}

TEST(Classify, NamesTheModelOfAView) {
    const ModelLibrary& library = shared_library();
    const EntryIndex index(library);
    for (std::uint32_t m = 0; m < 2; ++m) {
        const Model& model = library.models[m];
        ViewSettings views = library.settings.views;
        views.count = 12;  // none of the library's viewpoints
        const ModelView view = make_view(RayScene({model.mesh}), model.shape, views, 3);
        const PreparedSegment segment{view.cloud, view.cloud};  // as entries are: sampled once
        for (const char* name : {"fused", "keypoints", "esf", "shot"}) {
            const auto ranking = classify(index, segment, name, 1);
            EXPECT_EQ(ranking.front().model, m) << name;
        }
    }
    const PreparedSegment whole{library.models[0].surface, library.models[0].surface};
    EXPECT_THROW(classify(index, whole, "pfh", 1), InvalidInput);
    EXPECT_THROW(classify(index, {}, "fused", 1), InvalidInput);
}

TEST(PrepareSegment, KeepsTheWholeAndItsLargestPiece) {
    const LibrarySettings settings = shared_library().settings;
    const PointCloud& surface = shared_library().models[0].surface;
    PointCloud two = surface;
    two.normals.clear();
    two.viewpoint = Vec3f(0, 0, 1000);
    for (std::size_t i = 0; i < surface.size(); i += 3) {
        two.points.push_back(surface.points[i] + Vec3f(500, 0, 0));
    }
    const PreparedSegment both = prepare_segment(two, settings);
    EXPECT_GT(both.whole.size(), both.piece.size());
    EXPECT_GT(both.piece.size(), both.whole.size() / 2);
    for (const Vec3f& point : both.piece.points) EXPECT_LT(point.x(), 250.0F);
    LibrarySettings views = settings;
    views.full_views_only = true;
    EXPECT_EQ(prepare_segment(two, views).piece.size(), both.whole.size());
    EXPECT_TRUE(prepare_segment({}, settings).empty());
}

// What an entry stands for holds its own row, or nearly so, and more.
TEST(EntryIndex, SpreadsBringEntriesNearer) {
    const ModelLibrary& library = shared_library();
    ModelLibrary bare = library;
    for (DescriptorTable& table : bare.tables) table.spread = {};
    const EntryIndex with(library);
    const EntryIndex without(bare);
    for (std::size_t t = 0; t < library.tables.size(); ++t) {
        ASSERT_FALSE(library.tables[t].spread.empty());
        const std::size_t length = descriptor_length(library.tables[t].descriptor);
        double own = 0.0;
        double others = 0.0;
        for (std::size_t i = 0; i < library.entries.size(); ++i) {
            const auto row =
                std::span<const float>(library.tables[t].rows).subspan(i * length, length);
            own += double{with.distances(t, row)[i]};
            const auto far = without.distances(t, row);
            others += std::accumulate(far.begin(), far.end(), 0.0) / double(far.size() - 1);
        }
        EXPECT_LT(own, 0.5 * others) << t;
    }
}

TEST(EntryIndex, EveryMetricFindsAnEntrysOwnRow) {
    const ModelLibrary& library = library_of_rows();
    for (const Metric metric : {Metric::l1, Metric::l2, Metric::chi_square, Metric::hellinger}) {
        const EntryIndex index(library, metric);
        const auto row = std::span<const float>(library.tables[0].rows).subspan(308, 308);
        const auto nearest = nearest_entries(index.distances(0, row), 1);
        EXPECT_EQ(nearest[0].distance, 0.0F) << metric_name(metric);
    }
}

}  // namespace
}  // namespace ostraka
