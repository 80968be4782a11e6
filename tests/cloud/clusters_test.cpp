// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/clusters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

bool close(const Vec3f& a, const Vec3f& b, double tolerance) {
    return (a - b).squaredNorm() < static_cast<float>(tolerance * tolerance);
}

// Single linkage by relabeling: every close pair takes the smaller label, until nothing changes.
Clusters brute_force(const std::vector<Vec3f>& points, double tolerance,
                     const std::vector<std::uint32_t>& indices) {
    std::vector<std::uint32_t> label(points.size());
    std::iota(label.begin(), label.end(), 0U);
    for (bool changed = true; changed;) {
        changed = false;
        for (const std::uint32_t i : indices) {
            for (const std::uint32_t j : indices) {
                if (label[j] < label[i] && close(points[i], points[j], tolerance)) {
                    label[i] = label[j];
                    changed = true;
                }
            }
        }
    }
    Clusters clusters;
    for (const std::uint32_t root : indices) {
        std::vector<std::uint32_t> members;
        for (const std::uint32_t i : indices) {
            if (label[i] == root) members.push_back(i);
        }
        if (!members.empty()) clusters.push_back(members);
    }
    std::stable_sort(clusters.begin(), clusters.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    return clusters;
}

std::vector<std::uint32_t> all_of(const std::vector<Vec3f>& points) {
    std::vector<std::uint32_t> indices(points.size());
    std::iota(indices.begin(), indices.end(), 0U);
    return indices;
}

TEST(EuclideanClusters, AgreeWithBruteForce) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const std::vector<Vec3f> points = test_clouds::in_box(300, seed);
        for (const double tolerance : {0.05, 0.15, 0.22, 0.4}) {
            EXPECT_EQ(euclidean_clusters(points, tolerance),
                      brute_force(points, tolerance, all_of(points)));
        }
    }
}

TEST(EuclideanClusters, LeaveOutSmallGroups) {
    const std::vector<Vec3f> points = test_clouds::in_box(300, 7);
    Clusters expected = brute_force(points, 0.15, all_of(points));
    std::erase_if(expected, [](const auto& group) { return group.size() < 4; });
    EXPECT_EQ(euclidean_clusters(points, 0.15, 4), expected);
    EXPECT_TRUE(euclidean_clusters(points, 0.15, 301).empty());
}

TEST(EuclideanClusters, ToleranceIsExclusive) {
    const std::vector<Vec3f> points = {{0, 0, 0}, {1, 0, 0}, {1.5F, 0, 0}};
    EXPECT_EQ(euclidean_clusters(points, 1.0), (Clusters{{1, 2}, {0}}));
    EXPECT_EQ(euclidean_clusters(points, 1.001), (Clusters{{0, 1, 2}}));
}

TEST(EuclideanClusters, OfNothingAreNone) {
    EXPECT_TRUE(euclidean_clusters({}, 1.0).empty());
    EXPECT_THROW(euclidean_clusters(test_clouds::in_box(3, 1), 0.0), InvalidInput);
}

TEST(ProximityGraph, HoldsEveryClosePairTwice) {
    const std::vector<Vec3f> points = test_clouds::in_box(250, 3);
    const double tolerance = 0.3;
    const ProximityGraph graph = proximity_graph(points, tolerance);
    ASSERT_EQ(graph.starts.size(), points.size() + 1);
    EXPECT_EQ(graph.starts.back(), graph.neighbors.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        std::vector<std::uint32_t> expected;
        for (std::uint32_t j = 0; j < points.size(); ++j) {
            if (i != j && close(points[i], points[j], tolerance)) expected.push_back(j);
        }
        std::vector<std::uint32_t> found(graph.neighbors.begin() + graph.starts[i],
                                         graph.neighbors.begin() + graph.starts[i + 1]);
        std::sort(found.begin(), found.end());
        ASSERT_EQ(found, expected);
    }
}

TEST(LargestGroup, OfAnySubsetAgreesWithBruteForce) {
    const std::vector<Vec3f> points = test_clouds::in_box(250, 4);
    const double tolerance = 0.25;
    const ProximityGraph graph = proximity_graph(points, tolerance);
    Random random(5);
    for (int trial = 0; trial < 20; ++trial) {
        const double share = random.uniform();
        std::vector<std::uint32_t> subset;
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            if (random.uniform() < share) subset.push_back(i);
        }
        const Clusters expected = brute_force(points, tolerance, subset);
        const std::vector<std::uint32_t> found = largest_group(graph, subset);
        ASSERT_EQ(found, expected.empty() ? std::vector<std::uint32_t>{} : expected.front());
    }
}

TEST(LargestGroups, OfNestedSubsetsAreTheLargestGroupOfEach) {
    const std::vector<Vec3f> points = test_clouds::in_box(400, 11);
    const ProximityGraph graph = proximity_graph(points, 0.25);
    std::vector<std::uint8_t> level(points.size());
    for (std::size_t i = 0; i < level.size(); ++i) {
        level[i] = static_cast<std::uint8_t>(4.9F * std::abs(points[i].x()));  // some in no subset
    }
    const auto groups = largest_groups(graph, level, 4);
    ASSERT_EQ(groups.size(), 4U);
    for (std::size_t l = 0; l < 4; ++l) {
        std::vector<std::uint32_t> subset;
        for (std::uint32_t i = 0; i < level.size(); ++i) {
            if (level[i] <= l) subset.push_back(i);
        }
        EXPECT_EQ(groups[l], largest_group(graph, subset)) << l;
        EXPECT_GT(groups[l].size(), 1U);
    }
    EXPECT_EQ(largest_groups(graph, std::vector<std::uint8_t>(points.size(), 9), 2)[1].size(), 0U);
}

TEST(LargestGroup, OfEquallyLargeOnesHasTheSmallestIndex) {
    const std::vector<Vec3f> points = {{0, 0, 0}, {9, 0, 0}, {9.1F, 0, 0}, {0.1F, 0, 0}};
    const ProximityGraph graph = proximity_graph(points, 1.0);
    const std::vector<std::uint32_t> all = {0, 1, 2, 3};
    EXPECT_EQ(largest_group(graph, all), (std::vector<std::uint32_t>{0, 3}));
    EXPECT_TRUE(largest_group(graph, {}).empty());
}

// Three squares of 20 x 20 points that meet in a corner, with exact normals.
PointCloud box_corner() {
    PointCloud cloud;
    for (int axis = 0; axis < 3; ++axis) {
        for (int i = 0; i < 20; ++i) {
            for (int j = 0; j < 20; ++j) {
                Vec3f point = Vec3f::Zero();
                point[(axis + 1) % 3] = 0.5F + static_cast<float>(i);
                point[(axis + 2) % 3] = 0.5F + static_cast<float>(j);
                cloud.points.push_back(point);
                cloud.normals.push_back(Vec3f::Unit(axis));
            }
        }
    }
    return cloud;
}

TEST(SmoothClusters, SplitABoxCornerIntoItsFaces) {
    const PointCloud cloud = box_corner();
    ASSERT_EQ(euclidean_clusters(cloud.points, 1.6).size(), 1U) << "distance alone can't split it";
    const Clusters clusters = smooth_clusters(cloud, {.tolerance = 1.6, .min_size = 50});
    ASSERT_EQ(clusters.size(), 3U);
    std::size_t on_own_face = 0;
    std::size_t total = 0;
    for (const auto& cluster : clusters) {
        std::array<std::size_t, 3> faces{};
        for (const std::uint32_t i : cluster) ++faces.at(i / 400);
        on_own_face += *std::max_element(faces.begin(), faces.end());
        total += cluster.size();
    }
    EXPECT_EQ(total, cloud.size()) << "points on the creases belong to a face, too";
    EXPECT_GT(on_own_face, total * 95 / 100);
}

// Two flat sheets that meet in a fillet of 11 rows, which turns by 0.15 radians a row: no pair of
// neighbors disagrees, only the curvature tells the sheets apart.
TEST(SmoothClusters, SplitSheetsAtASharpFillet) {
    PointCloud cloud;
    Vec3d at(0.0, 0.0, 0.0);
    for (int row = 0; row < 51; ++row) {
        const double angle = 0.15 * std::clamp(row - 20, 0, 10);
        const Vec3d along(std::cos(angle), 0.0, -std::sin(angle));
        for (int j = 0; j < 20; ++j) {
            cloud.points.push_back(Vec3d(at + Vec3d(0.0, j, 0.0)).cast<float>());
            cloud.normals.push_back(Vec3d(std::sin(angle), 0.0, std::cos(angle)).cast<float>());
        }
        at += along;
    }
    const SmoothnessSettings settings{.tolerance = 3.2, .max_angle = 0.5};
    const Clusters clusters = smooth_clusters(cloud, settings);
    ASSERT_EQ(clusters.size(), 2U);
    EXPECT_EQ(clusters[0].size() + clusters[1].size(), cloud.size());
    EXPECT_GT(clusters[1].size(), 400U);
    SmoothnessSettings lenient = settings;
    lenient.max_curvature = 1.0;
    EXPECT_EQ(smooth_clusters(cloud, lenient).size(), 1U);
}

TEST(SmoothClusters, KeepACurvedSurfaceTogether) {
    const PointCloud cloud = test_clouds::sphere(5000, 10.0);
    const Clusters clusters = smooth_clusters(cloud, {.tolerance = 1.0});
    ASSERT_EQ(clusters.size(), 1U);
    EXPECT_EQ(clusters.front().size(), cloud.size());
}

TEST(SmoothClusters, DoNotDependOnTheOrderOfPoints) {
    const PointCloud cloud = box_corner();
    std::vector<std::uint32_t> order = all_of(cloud.points);
    Random random(6);
    for (std::uint32_t i = static_cast<std::uint32_t>(order.size()) - 1; i > 0; --i) {
        std::swap(order[i], order[random.below(i + 1)]);
    }
    const SmoothnessSettings settings{.tolerance = 1.6, .max_curvature = 1.0};
    std::vector<std::vector<std::uint32_t>> renamed;
    for (auto cluster : smooth_clusters(select(cloud, order), settings)) {
        for (std::uint32_t& i : cluster) i = order[i];
        std::sort(cluster.begin(), cluster.end());
        renamed.push_back(cluster);
    }
    std::vector<std::vector<std::uint32_t>> expected = smooth_clusters(cloud, settings);
    std::sort(renamed.begin(), renamed.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(renamed, expected);
}

TEST(SmoothClusters, NeedNormals) {
    PointCloud cloud;
    cloud.points = test_clouds::in_box(10, 1);
    EXPECT_THROW(smooth_clusters(cloud, {.tolerance = 1.0}), InvalidInput);
    EXPECT_TRUE(smooth_clusters({}, {.tolerance = 1.0}).empty());
}

}  // namespace
}  // namespace ostraka
