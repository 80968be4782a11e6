// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/rops.hpp"

#include <gtest/gtest.h>

#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/rops_statistics.hpp"

namespace ostraka {
namespace {

std::vector<Vec3f> some_keypoints(const PointCloud& cloud) {
    std::vector<Vec3f> keypoints;
    for (std::size_t i = 0; i < cloud.size(); i += 25) keypoints.push_back(cloud.points[i]);
    return keypoints;
}

TEST(Rops, RowsHaveNormOneAndFramesAreRotations) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(2'000);
    const auto triangles = triangulate(cloud);
    const auto keypoints = some_keypoints(cloud);
    const auto result =
        describe_rops(cloud, KdTree(cloud.points), triangles, keypoints, {.radius = 15.0F});
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
        double norm = 0.0;
        for (std::size_t i = 0; i < kRopsLength; ++i) {
            norm += std::abs(result.rows[k * kRopsLength + i]);
        }
        EXPECT_NEAR(norm, 1.0, 1e-5);
        EXPECT_LE((result.frames[k] * result.frames[k].transpose() - Mat3f::Identity()).norm(),
                  1e-5F);
        EXPECT_GT(result.frames[k].determinant(), 0.0F);
    }
}

TEST(Rops, FrameOfOneTriangleLooksAtIt) {
    // The triangle's long side runs along x, its plane is z = 0, seen from below and aside.
    PointCloud cloud;
    cloud.points = {{1.0F, -0.1F, 2.0F}, {5.0F, -0.1F, 2.0F}, {3.0F, 0.3F, 2.0F}};
    const std::vector<IndexTriangle> triangles = {{0, 1, 2}};
    const std::vector<Vec3f> keypoints = {Vec3f(3.0F, 0.0F, 2.0F)};
    const auto result =
        describe_rops(cloud, KdTree(cloud.points), triangles, keypoints, {.radius = 4.0F});
    EXPECT_NEAR(std::abs(result.frames[0](0, 0)), 1.0F, 1e-3F);
    EXPECT_NEAR(std::abs(result.frames[0](2, 2)), 1.0F, 1e-5F);
}

TEST(Rops, UniformGridHasTheMomentsOfAUniformDistribution) {
    // 5 x 5 x 5 points, unrotated about their own axis: the plane across it sees 25 equal bins
    // after no turn; with the turns of RoPS only symmetry can be checked: odd moments are 0.
    Support support;
    support.resize(2'197, false);
    std::size_t i = 0;
    for (int x = -6; x <= 6; ++x) {
        for (int y = -6; y <= 6; ++y) {
            for (int z = -6; z <= 6; ++z) {
                support.x[i] = static_cast<float>(x) + 0.01F * static_cast<float>(y);
                support.y[i] = static_cast<float>(y);
                support.z[i++] = static_cast<float>(z);
            }
        }
    }
    RopsScratch scratch;
    std::vector<float> row(kRopsLength);
    rops_statistics(support, Mat3f::Identity(), scratch, row);
    // About x by 22.5 degrees, plane xy: x is uniform and independent of the rest.
    const double scale = row[4];  // entropy
    EXPECT_NEAR(row[1] / scale, 0.0, 0.05);
    EXPECT_NEAR(row[2] / scale, 0.0, 0.05);
    EXPECT_GT(row[3], 0.0F);
    EXPECT_LT(row[4] / row[3], 3.22 / 1.0);  // the entropy is below log(25)
}

TEST(Rops, KeypointsWithoutTrianglesGetZerosAndNoFrame) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(500);
    const std::vector<Vec3f> keypoints = {Vec3f(1000.0F, 0.0F, 0.0F), cloud.points[0]};
    const KdTree tree(cloud.points);
    const auto far = describe_rops(cloud, tree, triangulate(cloud), keypoints, {.radius = 20.0F});
    for (std::size_t i = 0; i < kRopsLength; ++i) EXPECT_EQ(far.rows[i], 0.0F);
    EXPECT_TRUE(far.frames[0].array().isNaN().all());
    EXPECT_TRUE(far.frames[1].allFinite());
    const auto bare = describe_rops(cloud, tree, {}, keypoints, {.radius = 20.0F});
    EXPECT_EQ(bare.rows, std::vector<float>(2 * kRopsLength, 0.0F));
}

TEST(Rops, LocalFramesMoveWithTheCloud) {
    const PointCloud cloud = shapes::cut_torus(3'000);
    Pose T_b_a = Pose::Identity();
    T_b_a.linear() = Random(8).rotation();
    const PointCloud moved = transformed(cloud, T_b_a);
    const auto triangles = triangulate(cloud);
    const RopsSettings settings{.radius = 15.0F};
    const auto a =
        describe_rops(cloud, KdTree(cloud.points), triangles, some_keypoints(cloud), settings);
    const auto b =
        describe_rops(moved, KdTree(moved.points), triangles, some_keypoints(moved), settings);
    const Mat3f R = T_b_a.linear().cast<float>();
    for (std::size_t k = 0; k < a.frames.size(); ++k) {
        EXPECT_LE((b.frames[k] * R - a.frames[k]).norm(), 5e-3F);
    }
    EXPECT_LE(shapes::relative_l1(b.rows, a.rows), 5e-3);  // single points change bins
}

TEST(Rops, ThreadCountChangesNoBit) {
    const PointCloud cloud = shapes::notched_box(1'500);
    const auto triangles = triangulate(cloud);
    const KdTree tree(cloud.points);
    set_thread_count(1);
    const auto one =
        describe_rops(cloud, tree, triangles, some_keypoints(cloud), {.radius = 15.0F});
    set_thread_count(0);
    const auto many =
        describe_rops(cloud, tree, triangles, some_keypoints(cloud), {.radius = 15.0F});
    EXPECT_EQ(many.rows, one.rows);
}

TEST(Rops, TreeIsNotNeeded) {
    const PointCloud cloud = shapes::cut_torus(700);
    const auto triangles = triangulate(cloud);
    const auto keypoints = some_keypoints(cloud);
    const RopsSettings settings{.radius = 9.0F};
    const auto with = describe_rops(cloud, KdTree(cloud.points), triangles, keypoints, settings);
    EXPECT_EQ(with.rows, describe_rops(cloud, triangles, keypoints, settings).rows);
}

TEST(Rops, FramesComeFromAllTrianglesWithACornerInTheSupport) {
    // The paper's double sum over the corners, written out.
    const PointCloud cloud = shapes::bumpy_ellipsoid(1'500);
    const auto triangles = triangulate(cloud, {.longest_edge = 30.0F});
    const float radius = 8.0F;
    const std::vector<Vec3f> keypoints = some_keypoints(cloud);
    const auto result = describe_rops(cloud, triangles, keypoints, {.radius = radius});
    std::size_t compared = 0;
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
        const Vec3d p = keypoints[k].cast<double>();
        Mat3d scatter = Mat3d::Zero();
        for (const IndexTriangle& t : triangles) {
            std::array<Vec3d, 3> a;
            bool near = false;
            for (std::size_t c = 0; c < 3; ++c) {
                a[c] = cloud.points[t[c]].cast<double>() - p;
                near = near || a[c].norm() < radius;
            }
            if (!near) continue;
            const double distance = ((a[0] + a[1] + a[2]) / 3.0).norm();
            const double weight =
                (a[1] - a[0]).cross(a[2] - a[0]).norm() * std::pow(radius - distance, 2.0);
            for (std::size_t i = 0; i < 3; ++i) {
                scatter += weight * a[i] * a[i].transpose();
                for (std::size_t j = 0; j < 3; ++j) scatter += weight * a[i] * a[j].transpose();
            }
        }
        const Vec3d z = result.frames[k].row(2).transpose().cast<double>();
        const Vec3d x = result.frames[k].row(0).transpose().cast<double>();
        // Eigenvectors: the scatter maps the axes to multiples of themselves.
        EXPECT_LE((scatter * z - z.dot(scatter * z) * z).norm(), 1e-5 * scatter.norm());
        EXPECT_LE((scatter * x - x.dot(scatter * x) * x).norm(), 1e-5 * scatter.norm());
        EXPECT_GE(x.dot(scatter * x), z.dot(scatter * z));
        ++compared;
    }
    EXPECT_GE(compared, 50U);
}

TEST(Rops, BadArgumentsAreRejected) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(50);
    const KdTree tree(cloud.points);
    const std::vector<IndexTriangle> wrong = {{0, 1, 50}};
    EXPECT_THROW(describe_rops(cloud, tree, wrong, cloud.points, {.radius = 1.0F}), InvalidInput);
    EXPECT_THROW(describe_rops(cloud, tree, {}, cloud.points, {}), InvalidInput);
    EXPECT_THROW(describe_global_rops({}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
