// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/neighborhood_moments.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cloud/test_clouds.hpp"
#include "ostraka/cloud/kdtree.hpp"

namespace ostraka {
namespace {

using Sums = std::array<double, 9>;

std::vector<Sums> nearest_sums(std::span<const Vec3f> points, std::size_t k) {
    std::vector<Sums> all(points.size());
    std::vector<int> visits(points.size(), 0);
    visit_nearest_moments(points, k, [&](const MomentBatch& batch) {
        EXPECT_EQ(batch.neighbors, static_cast<double>(std::min(k, points.size())));
        for (std::size_t lane = 0; lane < batch.count; ++lane) {
            ++visits[batch.index[lane]];
            for (std::size_t s = 0; s < 9; ++s) all[batch.index[lane]][s] = batch.sums[s][lane];
        }
    });
    for (const int count : visits) EXPECT_EQ(count, 1);
    return all;
}

// The tree gives the same neighbors in order: nearest first, of equal ones lowest index first.
void expect_those_of_the_tree(std::span<const Vec3f> points, std::size_t k) {
    const std::vector<Sums> found = nearest_sums(points, k);
    const KdTree tree(points);
    std::vector<Neighbor> neighbors;
    for (std::size_t i = 0; i < points.size(); ++i) {
        tree.nearest(points[i], k, neighbors);
        Sums expected{};
        double squares = 0.0;
        for (const Neighbor& n : neighbors) {
            const Vec3d d = points[n.index].cast<double>() - points[i].cast<double>();
            const Sums terms = {d.x(),         d.y(),         d.z(),
                                d.x() * d.x(), d.x() * d.y(), d.x() * d.z(),
                                d.y() * d.y(), d.y() * d.z(), d.z() * d.z()};
            for (std::size_t s = 0; s < 9; ++s) expected[s] += terms[s];
            squares += d.squaredNorm();
        }
        const double length = std::sqrt(squares * static_cast<double>(neighbors.size()));
        for (std::size_t s = 0; s < 9; ++s) {
            ASSERT_NEAR(found[i][s], expected[s], 1e-6 * (s < 3 ? length : squares))
                << "point " << i << ", sum " << s;
        }
    }
}

TEST(NeighborhoodMoments, OnASurfaceAreThoseOfTheTree) {
    const PointCloud cloud = test_clouds::sphere(3000, 25.0);
    for (const std::size_t k : {3, 10, 20, 61}) expect_those_of_the_tree(cloud.points, k);
}

TEST(NeighborhoodMoments, InAVolumeAreThoseOfTheTree) {
    expect_those_of_the_tree(test_clouds::in_box(2000, 3, {9, 1, 4}, {100, 200, -300}), 20);
}

// Most k-th distances on a lattice occur several times: the lowest indices win.
TEST(NeighborhoodMoments, BreakTiesByIndex) {
    expect_those_of_the_tree(test_clouds::lattice(25, 0.5F), 7);
    expect_those_of_the_tree(test_clouds::lattice(25, 0.5F), 20);
}

TEST(NeighborhoodMoments, FollowTheDensity) {
    std::vector<Vec3f> points = test_clouds::in_box(1500, 4, {0.1, 0.1, 0.01});
    for (const Vec3f& p : test_clouds::in_box(700, 5, {20, 20, 5})) points.push_back(p);
    for (const Vec3f& p : test_clouds::in_box(40, 6, {3000, 3000, 100})) points.push_back(p);
    points.emplace_back(1e7F, 0.0F, 0.0F);
    expect_those_of_the_tree(points, 20);
}

TEST(NeighborhoodMoments, TakeDuplicatesAndSmallClouds) {
    std::vector<Vec3f> points = test_clouds::in_box(300, 7);
    for (int copy = 0; copy < 5; ++copy) {
        for (std::size_t i = 0; i < 100; ++i) points.push_back(points[i]);
    }
    points.insert(points.end(), 400, Vec3f(0.2F, 0.1F, 0.3F));
    expect_those_of_the_tree(points, 20);
    expect_those_of_the_tree(std::vector<Vec3f>(40, Vec3f(1, 2, 3)), 20);
    for (const std::size_t count : {1, 2, 7, 19, 20, 21}) {
        expect_those_of_the_tree(test_clouds::in_box(count, 8), 20);
    }
    visit_nearest_moments({}, 20, [](const MomentBatch&) { FAIL() << "nothing to visit"; });
}

TEST(NeighborhoodMoments, TakeLinesExactly) {
    std::vector<Vec3f> line;
    for (int i = 0; i < 500; ++i) line.emplace_back(0.1F * static_cast<float>(i), 3.0F, 2.0F);
    for (const Sums& sums : nearest_sums(line, 20)) {
        EXPECT_EQ(sums[6], 0.0);
        EXPECT_EQ(sums[8], 0.0);
    }
    expect_those_of_the_tree(line, 20);
}

}  // namespace
}  // namespace ostraka
