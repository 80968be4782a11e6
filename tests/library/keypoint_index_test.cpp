// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/keypoint_index.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "ostraka/library/retrieval.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

const ModelLibrary& library() {
    static const ModelLibrary built =
        build_library(testing::simple_models(), testing::quick_settings());
    return built;
}

SceneKeypoints scene() {
    PointCloud cloud = library().models[0].surface;
    return scene_keypoints(cloud, library().settings, 3.0, 100);
}

TEST(SceneKeypoints, AreSpreadThinnedAndFramed) {
    const SceneKeypoints keypoints = scene();
    ASSERT_GT(keypoints.size(), 10U);
    EXPECT_LE(keypoints.size(), 100U);
    EXPECT_EQ(keypoints.rows.size(), keypoints.size() * kShotLength);
    for (const Mat3f& frame : keypoints.frames) {
        EXPECT_NEAR(frame.determinant(), 1.0F, 1e-4F);
    }
}

TEST(KeypointIndex, AgreesWithBruteForce) {
    const SceneKeypoints keypoints = scene();
    const auto matches = KeypointIndex(library()).match(keypoints);
    ASSERT_EQ(matches.size(), library().models.size());
    for (std::size_t m = 0; m < matches.size(); ++m) {
        const Keypoints& model = library().models[m].keypoints;
        ASSERT_EQ(matches[m].size(), keypoints.size());
        for (std::size_t k = 0; k < keypoints.size(); ++k) {
            std::int32_t best = std::numeric_limits<std::int32_t>::max();
            for (std::size_t r = 0; r < model.size(); ++r) {
                std::int32_t sum = 0;
                for (std::size_t i = 0; i < kShotLength; ++i) {
                    const std::int32_t difference =
                        std::int32_t{keypoints.rows[k * kShotLength + i]} -
                        std::int32_t{model.rows[r * kShotLength + i]};
                    sum += difference * difference;
                }
                best = std::min(best, sum);
            }
            EXPECT_EQ(matches[m][k].distance, best);
            EXPECT_EQ(matches[m][k].scene_point, keypoints.points[k]);
        }
    }
}

TEST(KeypointIndex, AModelWithoutKeypointsHasNoMatches) {
    ModelLibrary bare = library();
    bare.models[1].keypoints = {};
    const auto matches = KeypointIndex(bare).match(scene());
    EXPECT_FALSE(matches[0].empty());
    EXPECT_TRUE(matches[1].empty());
}

TEST(KeypointIndex, AGraphFindsTheNearestOfAllModels) {
    ModelLibrary indexed = library();
    const std::vector<std::uint8_t> bytes = all_keypoint_rows(indexed);
    indexed.keypoint_graph = build_neighbor_graph({bytes, kShotLength});
    const SceneKeypoints keypoints = scene();
    const auto exact = KeypointIndex(library()).match(keypoints);
    const auto found = KeypointIndex(indexed).match(keypoints);
    ASSERT_EQ(found.size(), exact.size());
    std::size_t agreed = 0;
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
        std::size_t nearest = 0;
        for (std::size_t m = 0; m < exact.size(); ++m) {
            if (exact[m][k].distance < exact[nearest][k].distance) nearest = m;
            if (!found[m][k].matched()) continue;
            EXPECT_GE(found[m][k].distance, exact[m][k].distance);
        }
        const Correspondence& match = found[nearest][k];
        if (match.distance != exact[nearest][k].distance) continue;
        ++agreed;
        EXPECT_EQ(match.scene_point, keypoints.points[k]);
        EXPECT_LT(
            (match.R_scene_model.transpose() * match.R_scene_model - Mat3f::Identity()).norm(),
            1e-4F);
    }
    EXPECT_GE(agreed * 100, keypoints.size() * 97);
}

}  // namespace
}  // namespace ostraka
