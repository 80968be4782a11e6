// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/keypoint_matching.hpp"

#include <algorithm>

#include "ostraka/base/parallel.hpp"
#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

std::vector<std::vector<Correspondence>> matches_of(const Scan& scan) {
    return match_keypoints(scan, library().settings, KeypointIndex(library()), {});
}

Pose random_pose(Random& random) {
    Pose T_scene_model = Pose::Identity();
    T_scene_model.linear() = random.rotation();
    T_scene_model.translation() = 200.0 * random.direction();
    return T_scene_model;
}

Vec3f anywhere(Random& random) {
    return Vec3d(random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-50, 50))
        .cast<float>();
}

// A match of two places without relation.
Correspondence outlier(Random& random, std::int32_t distance) {
    return {anywhere(random), anywhere(random), random.rotation().cast<float>(), distance};
}

TEST(PosesFromMatches, OneMatchGivesThePoseOfItsFrames) {
    Random random(1);
    const Pose truth = random_pose(random);
    const Vec3f at(3.0F, -7.0F, 20.0F);
    const Correspondence match{(truth * at.cast<double>()).cast<float>(), at,
                               truth.linear().cast<float>(), 5};
    const auto poses = poses_from_matches({&match, 1}, 1.0);
    ASSERT_EQ(poses.size(), 1U);
    EXPECT_LT((poses[0].matrix() - truth.matrix()).norm(), 1e-4);
}

TEST(PosesFromMatches, AConsistentGroupIsFoundAmongOutliers) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        Random random(seed);
        const Pose truth = random_pose(random);
        std::vector<Correspondence> matches;
        for (std::int32_t i = 0; i < 60; ++i) {
            matches.push_back(outlier(random, i));
            if (i % 6 != 0) continue;
            // Right places with useless frames: only their group can tell the pose.
            Correspondence& match = matches.back();
            match.scene_point = (truth * match.model_point.cast<double>()).cast<float>();
        }
        const auto poses = poses_from_matches(matches, 1.0);
        ASSERT_GE(poses.size(), matches.size());
        const bool found = std::any_of(poses.begin(), poses.end(), [&](const Pose& pose) {
            return (pose.matrix() - truth.matrix()).norm() < 0.05;
        });
        EXPECT_TRUE(found) << seed;
    }
}

TEST(PosesFromMatches, NothingFromNothing) {
    EXPECT_TRUE(poses_from_matches({}, 1.0).empty());
}

TEST(MatchKeypoints, TheBestMatchesOfAModelsOwnViewAreRight) {
    for (const std::uint32_t model : {kCorner, kPlate}) {
        const SimulatedScene scene = alone(model, 3);
        const auto matches = matches_of(prepared(scene));
        ASSERT_EQ(matches.size(), library().models.size());
        ASSERT_GT(matches[model].size(), 40U);
        EXPECT_EQ(matches[kCorner].size(), matches[kPlate].size());
        for (const auto& of_model : matches) {
            EXPECT_TRUE(std::is_sorted(
                of_model.begin(), of_model.end(),
                [](const auto& a, const auto& b) { return a.distance < b.distance; }));
        }
        const Pose& truth = scene.objects[0].T_scene_model;
        // Edges of boxes look alike, so that many matches miss; far more are right than by chance.
        const auto right_share = [&](const Pose& T_scene_model) {
            const std::size_t count = matches[model].size() / 2;
            double right = 0.0;
            for (std::size_t i = 0; i < count; ++i) {
                const Correspondence& match = matches[model][i];
                const Vec3d expected = T_scene_model * match.model_point.cast<double>();
                right += (expected - match.scene_point.cast<double>()).norm() < 8.0 ? 1.0 : 0.0;
            }
            return right / static_cast<double>(count);
        };
        double chance = 0.0;
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
            const Vec3d& center = models().shapes[model].center;
            chance += right_share(disturbed(truth, center, 2.0, 0.0, seed)) / 20.0;
        }
        EXPECT_GT(right_share(truth), 5.0 * chance) << model;
    }
}

TEST(MatchKeypoints, LeadToThePose) {
    const SimulatedScene scene = alone(kPlate, 6);
    const Scan scan = prepared(scene);
    const auto matches = matches_of(scan);
    double best = 1.0;
    for (const Pose& pose : poses_from_matches(matches[kPlate], 2.0 * scan.sampling)) {
        best = std::min(best, pose_error(kPlate, scene.objects[0].T_scene_model, pose));
    }
    EXPECT_LT(best, 0.05);
}

TEST(MatchKeypoints, AreTheSameForAnyNumberOfThreads) {
    const Scan scan = prepared(alone(kCorner, 2));
    set_thread_count(1);
    const auto one = matches_of(scan);
    set_thread_count(4);
    const auto four = matches_of(scan);
    set_thread_count(0);
    for (std::size_t m = 0; m < one.size(); ++m) {
        ASSERT_EQ(one[m].size(), four[m].size());
        for (std::size_t i = 0; i < one[m].size(); ++i) {
            EXPECT_EQ(one[m][i].distance, four[m][i].distance);
            EXPECT_EQ(one[m][i].model_point, four[m][i].model_point);
            EXPECT_EQ(one[m][i].R_scene_model, four[m][i].R_scene_model);
        }
    }
}

}  // namespace
}  // namespace ostraka
