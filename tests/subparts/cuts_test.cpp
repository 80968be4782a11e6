// SPDX-License-Identifier: Apache-2.0
#include "ostraka/subparts/cuts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/cloud/clusters.hpp"

namespace ostraka {
namespace {

const CutSettings kSettings{.cluster_tolerance = 1.5};

// A flat sheet of 60 x 30 points, 1 apart, bent a little and skewed, seen from above.
PointCloud sheet() {
    PointCloud cloud;
    for (int i = 0; i < 60; ++i) {
        for (int j = 0; j < 30; ++j) {
            const double x = i;
            const double y = j;
            if (x > 40.0 && y > 10.0 + 0.3 * x) continue;
            cloud.points.push_back(Vec3d(x, y, 0.005 * x * x - 0.02 * y * y).cast<float>());
        }
    }
    cloud.viewpoint = Vec3f(30, 15, 200);
    return cloud;
}

class CutDirections : public testing::TestWithParam<int> {};

TEST_P(CutDirections, AreUniqueUnitVectorsInOppositePairs) {
    const std::vector<Vec3d> directions = cut_directions(GetParam());
    ASSERT_EQ(directions.size(), static_cast<std::size_t>(GetParam()));
    for (std::size_t i = 0; i < directions.size(); ++i) {
        EXPECT_NEAR(directions[i].norm(), 1.0, 1e-12);
        int opposites = 0;
        for (std::size_t j = 0; j < directions.size(); ++j) {
            const double apart = (directions[i] - directions[j]).norm();
            EXPECT_TRUE(i == j || apart > 0.5);
            opposites += (directions[i] + directions[j]).norm() < 1e-12 ? 1 : 0;
        }
        EXPECT_EQ(opposites, 1);
    }
}

INSTANTIATE_TEST_SUITE_P(Counts, CutDirections, testing::Values(6, 14, 26));

TEST(CutDirectionsOf, LargerSetsBeginWithTheSmaller) {
    const std::vector<Vec3d> all = cut_directions(26);
    for (const int count : {6, 14}) {
        const std::vector<Vec3d> some = cut_directions(count);
        EXPECT_TRUE(std::equal(some.begin(), some.end(), all.begin()));
    }
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(all[i].cwiseAbs().maxCoeff(), 1.0);
}

TEST(CutDirectionsOf, OtherCountsAreRejected) {
    for (const int count : {-6, 0, 1, 8, 20, 27}) EXPECT_THROW(cut_directions(count), InvalidInput);
}

TEST(CutBelow, AgreesWithBruteForce) {
    PointCloud cloud;
    cloud.points = test_clouds::in_box(500, 1, {3.0, 2.0, 1.0}, {5.0, -7.0, 9.0});
    Random random(2);
    for (int trial = 0; trial < 50; ++trial) {
        const Vec3d direction = random.direction();
        const double fraction = random.uniform();
        double low = 1e9;
        double high = -1e9;
        for (const Vec3f& point : cloud.points) {
            low = std::min(low, direction.dot(point.cast<double>()));
            high = std::max(high, direction.dot(point.cast<double>()));
        }
        const std::vector<std::uint32_t> found = cut_below(cloud, direction, fraction);
        EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
        const std::set<std::uint32_t> kept(found.begin(), found.end());
        EXPECT_EQ(kept.size(), found.size());
        for (std::uint32_t i = 0; i < cloud.size(); ++i) {
            const double along = direction.dot(cloud.points[i].cast<double>());
            const double excess = along - (low + fraction * (high - low));
            if (std::abs(excess) < 1e-5) continue;  // float rounding decides
            ASSERT_EQ(kept.count(i), excess < 0.0 ? 1U : 0U);
        }
    }
}

TEST(CutBelow, KeepsTheFractionOfAnEvenCloud) {
    PointCloud cloud;
    cloud.points = test_clouds::lattice(101, 1.0F);
    for (const double fraction : {0.25, 0.5, 0.75}) {
        const auto expected = static_cast<std::size_t>(100.0 * fraction + 1.0) * 101;
        EXPECT_EQ(cut_below(cloud, Vec3d::UnitX(), fraction).size(), expected);
        EXPECT_EQ(cut_below(cloud, -Vec3d::UnitY(), fraction).size(), expected);
    }
}

TEST(CutBelow, WholeFractionKeepsAllAndEmptyCloudsStayEmpty) {
    PointCloud cloud;
    cloud.points = test_clouds::in_box(100, 3);
    EXPECT_EQ(cut_below(cloud, Vec3d::UnitZ(), 1.0).size(), 100U);
    EXPECT_EQ(cut_below(cloud, Vec3d::UnitZ(), 0.0).size(), 1U);
    EXPECT_TRUE(cut_below({}, Vec3d::UnitZ(), 0.5).empty());
}

TEST(CutView, CountsAddUp) {
    const PointCloud cloud = sheet();
    const PrincipalFrame frame = principal_frame(cloud);
    for (const int directions : {6, 14, 26}) {
        CutSettings settings = kSettings;
        settings.directions = directions;
        settings.fractions = {0.1, 0.4, 0.9};
        settings.min_share = 0.3;
        const CutResult result = cut_view(cloud, frame, settings);
        EXPECT_EQ(result.made, static_cast<std::size_t>(3 * directions));
        EXPECT_EQ(result.subparts.size() + result.dropped_by_size, result.made);
        EXPECT_GT(result.subparts.size(), 0U);
        EXPECT_GT(result.dropped_by_size, 0U);
    }
}

TEST(CutView, EachSubpartIsTheLargestClusterOfItsCut) {
    const PointCloud cloud = sheet();
    const PrincipalFrame frame = principal_frame(cloud);
    const CutResult result = cut_view(cloud, frame, kSettings);
    const std::vector<Vec3d> directions = cut_directions(kSettings.directions);
    std::pair<int, int> previous = {-1, -1};
    for (const Subpart& subpart : result.subparts) {
        const std::pair<int, int> current = {subpart.direction, subpart.fraction};
        EXPECT_LT(previous, current) << "by direction, then fraction";
        previous = current;
        const Vec3d direction =
            frame.T_cloud_frame.linear() * directions.at(static_cast<std::size_t>(current.first));
        const std::vector<std::uint32_t> cut = cut_below(
            cloud, direction, kSettings.fractions.at(static_cast<std::size_t>(current.second)));
        const Clusters clusters =
            euclidean_clusters(select(cloud, cut).points, kSettings.cluster_tolerance);
        std::vector<std::uint32_t> expected;
        for (const std::uint32_t i : clusters.front()) expected.push_back(cut[i]);
        ASSERT_EQ(subpart.indices, expected);
        ASSERT_GE(subpart.indices.size(), kSettings.min_points);
        ASSERT_GE(static_cast<double>(subpart.indices.size()),
                  kSettings.min_share * static_cast<double>(cloud.size()));
    }
}

TEST(CutView, LargerFractionsKeepMore) {
    const PointCloud cloud = sheet();
    const CutResult result = cut_view(cloud, principal_frame(cloud), kSettings);
    for (std::size_t i = 1; i < result.subparts.size(); ++i) {
        const Subpart& a = result.subparts[i - 1];
        const Subpart& b = result.subparts[i];
        if (a.direction != b.direction) continue;
        EXPECT_TRUE(
            std::includes(b.indices.begin(), b.indices.end(), a.indices.begin(), a.indices.end()));
    }
}

TEST(CutView, DropsWhatIsBelowTheLeastPointsOrShare) {
    const PointCloud cloud = sheet();
    const PrincipalFrame frame = principal_frame(cloud);
    CutSettings settings = kSettings;
    settings.min_points = cloud.size() + 1;
    EXPECT_EQ(cut_view(cloud, frame, settings).dropped_by_size, 26U * 4U);
    settings = kSettings;
    settings.min_share = 0.6;
    for (const Subpart& subpart : cut_view(cloud, frame, settings).subparts) {
        EXPECT_GE(static_cast<double>(subpart.indices.size()),
                  0.6 * static_cast<double>(cloud.size()));
    }
}

// The cut must go with the piece, not with the axes of the scan.
TEST(CutView, TurnsWithTheView) {
    const PointCloud cloud = sheet();
    const CutResult before = cut_view(cloud, principal_frame(cloud), kSettings);
    const Pose pose = test_clouds::random_pose(4, 20.0);
    const PointCloud turned = transformed(cloud, pose);
    const CutResult after = cut_view(turned, principal_frame(turned), kSettings);
    ASSERT_EQ(after.subparts.size(), before.subparts.size());
    for (std::size_t i = 0; i < before.subparts.size(); ++i) {
        const auto& a = before.subparts[i].indices;
        const auto& b = after.subparts[i].indices;
        std::vector<std::uint32_t> common;
        std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
        // Points at the cut may fall on either side.
        EXPECT_GT(common.size() + 3, std::max(a.size(), b.size()));
    }
}

TEST(CutView, NeedsAClusterTolerance) {
    const PointCloud cloud = sheet();
    EXPECT_THROW(cut_view(cloud, principal_frame(cloud), {}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
