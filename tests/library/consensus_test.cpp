// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/consensus.hpp"

#include <gtest/gtest.h>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

constexpr double kSampling = 1.0;

Vec3d anywhere(Random& random) {
    return Vec3d(random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(-40, 40));
}

// Matches of one model: the first `right` of `count` keep one pose, the others are random.
std::vector<Correspondence> matches(std::size_t right, std::size_t count, std::int32_t distance,
                                    std::uint64_t seed) {
    Random scene_points(1);  // the same scene keypoints for every model
    Random random(seed, 1);
    const Mat3d R = random.rotation();
    std::vector<Correspondence> result;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d scene = anywhere(scene_points);
        Correspondence match;
        match.scene_point = scene.cast<float>();
        match.distance = distance;
        const Vec3d model =
            i < right ? Vec3d(R.transpose() * (scene - Vec3d(5, 6, 7))) : anywhere(random);
        match.model_point = model.cast<float>();
        match.R_scene_model = (i < right ? R : random.rotation()).cast<float>();
        result.push_back(match);
    }
    return result;
}

TEST(KeypointConsensus, IsTheShareThatAgrees) {
    const std::vector<std::vector<Correspondence>> both = {matches(30, 60, 100, 2),
                                                           matches(0, 60, 100, 3)};
    const auto consensus = keypoint_consensus(both, kSampling);
    EXPECT_NEAR(consensus[0], 0.5, 0.04);
    EXPECT_LT(consensus[1], 0.1);
    EXPECT_GT(consensus[1], 0.0);  // a match agrees with itself
}

TEST(KeypointConsensus, AMatchCountsLessTheBetterARivalFits) {
    const std::vector<std::vector<Correspondence>> both = {matches(60, 60, 200, 2),
                                                           matches(60, 60, 100, 3)};
    const auto consensus = keypoint_consensus(both, kSampling);
    EXPECT_NEAR(consensus[1], 1.0, 1e-9);
    // The excess is 100, the median of the nearest distances 100.
    EXPECT_NEAR(consensus[0], std::exp(-1.0), 1e-6);
}

TEST(KeypointConsensus, DoesNotDependOnTheOrderOfKeypointsOrThreads) {
    std::vector<std::vector<Correspondence>> both = {matches(30, 60, 100, 2),
                                                     matches(20, 60, 80, 3)};
    set_thread_count(1);
    const auto forward = keypoint_consensus(both, kSampling);
    set_thread_count(4);
    EXPECT_EQ(keypoint_consensus(both, kSampling), forward);
    set_thread_count(0);
    for (auto& of_model : both) std::reverse(of_model.begin(), of_model.end());
    const auto backward = keypoint_consensus(both, kSampling);
    for (std::size_t m = 0; m < 2; ++m) EXPECT_NEAR(backward[m], forward[m], 1e-12);
}

TEST(KeypointConsensus, NothingFromNothing) {
    EXPECT_TRUE(keypoint_consensus({}, kSampling).empty());
    const std::vector<std::vector<Correspondence>> none(3);
    EXPECT_EQ(keypoint_consensus(none, kSampling), std::vector<double>(3, 0.0));
    const std::vector<std::vector<Correspondence>> one = {matches(5, 5, 0, 2), {}};
    EXPECT_EQ(keypoint_consensus(one, kSampling)[1], 0.0);
    EXPECT_NEAR(keypoint_consensus(one, kSampling)[0], 1.0, 1e-9);
}

}  // namespace
}  // namespace ostraka
