// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/resample.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/cell_grid.hpp"

namespace ostraka {
namespace {

TEST(Resample, GivesOnePointACellAtItsCentroid) {
    PointCloud cloud;
    cloud.points = test_clouds::in_box(2000, 1);
    cloud.viewpoint = Vec3f(1, 2, 3);
    const double spacing = 0.25;
    const PointCloud result = resample(cloud, spacing);
    const CellGrid grid(cloud.points, spacing);
    ASSERT_EQ(result.size(), grid.cell_count());
    EXPECT_EQ(result.viewpoint, cloud.viewpoint);
    EXPECT_FALSE(result.organized());
    for (std::size_t c = 0; c < grid.cell_count(); ++c) {
        Vec3d mean = Vec3d::Zero();
        for (const std::uint32_t i : grid.members(c)) mean += cloud.points[i].cast<double>();
        mean /= static_cast<double>(grid.members(c).size());
        ASSERT_LT((result.points[c].cast<double>() - mean).norm(), 1e-6);
    }
}

TEST(Resample, KeepsTheWeightedCenterOfAllPoints) {
    PointCloud cloud;
    cloud.points = {{0.1F, 0.1F, 0.1F}, {0.3F, 0.1F, 0.1F}, {0.2F, 0.4F, 0.1F}, {5, 5, 5}};
    const PointCloud result = resample(cloud, 1.0);
    ASSERT_EQ(result.size(), 2U);
    EXPECT_LT((result.points[0] - Vec3f(0.2F, 0.2F, 0.1F)).norm(), 1e-6F);
    EXPECT_EQ(result.points[1], Vec3f(5, 5, 5));
}

TEST(Resample, LeavesOutInvalidPointsAndNormals) {
    PointCloud cloud;
    cloud.points = {{0, 0, 0}, test_clouds::nowhere(), {3, 0, 0}, {6, 0, 0}};
    cloud.normals = {{0, 0, 1}, {0, 0, 1}, test_clouds::nowhere(), {0, 0, 1}};
    cloud.width = 2;
    cloud.height = 2;
    const PointCloud result = resample(cloud, 1.0);
    ASSERT_EQ(result.size(), 2U);
    EXPECT_EQ(result.points[0], Vec3f(0, 0, 0));
    EXPECT_EQ(result.points[1], Vec3f(6, 0, 0));
    EXPECT_FALSE(result.organized());
}

TEST(Resample, AveragesNormalsAndColors) {
    PointCloud cloud;
    cloud.points = {{0, 0, 0}, {0.1F, 0, 0}, {5, 0, 0}, {5.1F, 0, 0}};
    cloud.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
    cloud.colors = {{10, 20, 30}, {20, 40, 255}, {1, 1, 1}, {1, 1, 1}};
    const PointCloud result = resample(cloud, 1.0);
    ASSERT_EQ(result.size(), 1U) << "normals that cancel drop the cell";
    EXPECT_LT((result.normals[0] - Vec3f(1, 1, 0).normalized()).norm(), 1e-6F);
    EXPECT_EQ(result.colors[0], (Color{15, 30, 142}));
    EXPECT_NO_THROW(check(result));
}

// Centroids stay in their cells, but the grid starts at the lowest centroid: a second pass may
// merge some neighbors, never create points or move them far.
TEST(Resample, SecondPassChangesLittle) {
    PointCloud cloud;
    cloud.points = test_clouds::lattice(200, 0.05F);
    const PointCloud once = resample(cloud, 0.5);
    const PointCloud twice = resample(once, 0.5);
    EXPECT_NEAR(static_cast<double>(once.size()), 400.0, 41.0);
    EXPECT_LE(twice.size(), once.size());
    EXPECT_GE(twice.size(), once.size() * 8 / 10);
}

TEST(Resample, ReachesTheSpacing) {
    const PointCloud dense = test_clouds::sphere(60'000, 10.0);
    PointCloud points_only;
    points_only.points = dense.points;
    const double spacing = 0.8;
    const double mr = mesh_resolution(resample(points_only, spacing).points);
    EXPECT_GT(mr, 0.5 * spacing);
    EXPECT_LT(mr, 1.0 * spacing);
}

TEST(Resample, EmptyStaysEmptyAndBadSpacingThrows) {
    EXPECT_TRUE(resample({}, 1.0).empty());
    PointCloud cloud;
    cloud.points = {{0, 0, 0}, {1, 1, 1}};
    EXPECT_THROW(resample(cloud, 0.0), InvalidInput);
    EXPECT_THROW(resample(cloud, 1e-9), InvalidInput);
}

TEST(MeshResolution, IsTheSpacingOfALattice) {
    EXPECT_NEAR(mesh_resolution(test_clouds::lattice(30, 0.7F)), 0.7, 1e-5);
    std::vector<Vec3f> turned = test_clouds::lattice(30, 0.7F);
    const Pose pose = test_clouds::random_pose(4);
    for (Vec3f& point : turned) point = (pose * point.cast<double>()).cast<float>();
    EXPECT_NEAR(mesh_resolution(turned), 0.7, 1e-4);
}

TEST(MeshResolution, OfUnevenPointsIsTheMeanGap) {
    // Gaps 1 and 3: the nearest of the four points are 1, 1, 3 and 3 away.
    const std::vector<Vec3f> points = {{0, 0, 0}, {1, 0, 0}, {4, 0, 0}, {7, 0, 0}};
    EXPECT_DOUBLE_EQ(mesh_resolution(points), 2.0);
}

TEST(MeshResolution, OfDuplicatesOrFewPointsIsZero) {
    EXPECT_EQ(mesh_resolution({}), 0.0);
    EXPECT_EQ(mesh_resolution(std::vector<Vec3f>{{1, 2, 3}}), 0.0);
    EXPECT_EQ(mesh_resolution(std::vector<Vec3f>(5, Vec3f(1, 2, 3))), 0.0);
}

TEST(MeshResolution, IsTheSameForAnyNumberOfThreads) {
    const std::vector<Vec3f> points = test_clouds::in_box(5000, 3);
    set_thread_count(1);
    const double one = mesh_resolution(points);
    set_thread_count(4);
    const double four = mesh_resolution(points);
    set_thread_count(0);
    EXPECT_EQ(one, four);
}

}  // namespace
}  // namespace ostraka
