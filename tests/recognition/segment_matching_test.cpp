// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/segment_matching.hpp"

#include <algorithm>

#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

// The object of the labeled point nearest to a place of the scan.
std::uint32_t label_at(const SimulatedScene& scene, const KdTree& tree,
                       const std::vector<std::uint32_t>& valid, const Vec3f& place) {
    return scene.labels[valid[tree.nearest(place).index]];
}

TEST(SegmentScan, ObjectsApartAreTheFirstSegments) {
    const SimulatedScene scene = tabletop({kCorner, kPlate}, 1);
    const Scan scan = prepared(scene);
    std::vector<std::uint32_t> valid;
    for (std::uint32_t i = 0; i < scene.cloud.size(); ++i) {
        if (scene.cloud.points[i].allFinite()) valid.push_back(i);
    }
    const PointCloud points = select(scene.cloud, valid);
    const KdTree tree(points.points);
    const auto segments = segment_scan(scan, 60);
    ASSERT_GE(segments.size(), 2U);
    std::vector<std::uint32_t> owners;
    for (std::size_t s = 0; s < 2; ++s) {
        std::vector<std::size_t> votes(3, 0);
        for (const std::uint32_t i : segments[s]) {
            const std::uint32_t label = label_at(scene, tree, valid, scan.cloud.points[i]);
            ++votes[label == kNoIndex ? 2 : label];
        }
        const auto most = std::max_element(votes.begin(), votes.end());
        EXPECT_GT(*most, segments[s].size() * 95 / 100);
        owners.push_back(static_cast<std::uint32_t>(most - votes.begin()));
    }
    std::sort(owners.begin(), owners.end());
    EXPECT_EQ(owners, (std::vector<std::uint32_t>{0, 1}));
}

TEST(SegmentScan, HoldsWhatIsNotExplainedAndNoSmallPieces) {
    Scan scan = prepared(tabletop({kCorner, kPlate}, 4));
    scan.explained.assign(scan.cloud.size(), 0);
    std::fill_n(scan.explained.begin(), scan.cloud.size() / 3, char{1});
    const auto segments = segment_scan(scan, 60);
    EXPECT_LE(segments.size(), 60U);
    for (const auto& segment : segments) {
        EXPECT_GE(segment.size(), 60U);
        EXPECT_TRUE(std::is_sorted(segment.begin(), segment.end()));
        EXPECT_TRUE(std::none_of(segment.begin(), segment.end(),
                                 [&](std::uint32_t i) { return scan.explained[i] != 0; }));
    }
    for (std::size_t s = 1; s < segments.size(); ++s) EXPECT_NE(segments[s], segments[s - 1]);
}

TEST(SegmentScan, SmoothPartsOfAnObjectAreSegmentsToo) {
    const Scan scan = prepared(alone(kPlate, 5));
    const auto segments = segment_scan(scan, 60);
    ASSERT_GE(segments.size(), 2U);
    const bool part = std::any_of(segments.begin() + 1, segments.end(), [&](const auto& segment) {
        return segment.size() < segments.front().size();
    });
    EXPECT_TRUE(part);
}

TEST(HypothesesFromSegments, OneOfThemIsNearTheTruth) {
    const EntryIndex index(library());
    int right = 0;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const auto model = static_cast<std::uint32_t>(seed % 2);
        const SimulatedScene scene = alone(model, seed);
        double best = 1.0;
        for (const Hypothesis& h : hypotheses_from_segments(prepared(scene), index, {})) {
            ASSERT_LT(h.model, 2U);
            EXPECT_EQ(h.source, HypothesisSource::segment);
            const Mat3d R = h.T_scene_model.linear();
            ASSERT_LT((R * R.transpose() - Mat3d::Identity()).norm(), 1e-6);
            ASSERT_NEAR(R.determinant(), 1.0, 1e-6);
            if (h.model != model) continue;
            best =
                std::min(best, pose_error(model, scene.objects[0].T_scene_model, h.T_scene_model));
        }
        right += best < 0.06 ? 1 : 0;
    }
    EXPECT_GE(right, 5);
}

}  // namespace
}  // namespace ostraka
