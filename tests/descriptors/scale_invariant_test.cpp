// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/scale_invariant.hpp"

#include <gtest/gtest.h>

#include "descriptors/bumpy_meshes.hpp"
#include "descriptors/local_testing.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/depth_patch.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kSisiLength = sisi_length({});

std::vector<ScaleKeypoint> keypoints_of(const shapes::Mesh& mesh) {
    return detect_scale_keypoints(mesh.cloud, mesh.triangles);
}

LocalDescriptors ld_sift(const shapes::Mesh& mesh, std::span<const ScaleKeypoint> keypoints) {
    return describe_ld_sift(mesh.cloud, mesh.triangles, keypoints);
}

TEST(Sisi, RowsStayUnderMotionAndScale) {
    const auto mesh = shapes::landscape(70);
    const auto a = describe_sisi(mesh.cloud, keypoints_of(mesh)).rows;
    ASSERT_GE(a.size(), 5 * kSisiLength);
    const auto larger = shapes::scaled(mesh, 2.5);
    const auto b = describe_sisi(larger.cloud, keypoints_of(larger)).rows;
    ASSERT_EQ(b.size(), a.size());
    EXPECT_EQ(shapes::different_rows(a, b, kSisiLength, 2e-3), 0U);
    const auto moved = shapes::moved(mesh, shapes::some_motion());
    const auto c = describe_sisi(moved.cloud, keypoints_of(moved)).rows;
    ASSERT_EQ(c.size(), a.size());
    EXPECT_EQ(shapes::different_rows(a, c, kSisiLength, 2e-3), 0U);
}

TEST(Sisi, EqualsASpinImageOfItsSize) {
    const auto mesh = shapes::landscape(50);
    const std::vector<ScaleKeypoint> keypoints = {{.index = 1'200, .level = 4, .scale = 2.0F}};
    const auto row = describe_sisi(mesh.cloud, keypoints, {.support = 3.0F, .width = 4}).rows;
    ASSERT_EQ(row.size(), 45U);
    double sum = 0.0;
    for (const float value : row) sum += value;
    EXPECT_NEAR(sum, 1.0, 1e-5);
    // Cylinder of radius 6, by hand: the center of mass of the distances.
    double expected = 0.0;
    int points = 0;
    for (std::size_t i = 0; i < mesh.cloud.size(); ++i) {
        const Vec3f offset = mesh.cloud.points[i] - mesh.cloud.points[1'200];
        const Vec3f& axis = mesh.cloud.normals[1'200];
        const float height = offset.dot(axis);
        const float across = (offset - height * axis).norm();
        if (i == 1'200 || !(across < 6.0F) || !(std::abs(height) < 6.0F)) continue;
        if (mesh.cloud.normals[i].dot(axis) < 0.0F) continue;
        expected += across / 1.5;
        ++points;
    }
    double mean = 0.0;
    for (std::size_t b = 0; b < row.size(); ++b) mean += row[b] * static_cast<double>(b / 9);
    EXPECT_GT(points, 50);
    EXPECT_NEAR(mean, expected / points, 1e-3);
}

TEST(LdSift, RowsStayUnderMotionAndScale) {
    const auto mesh = shapes::landscape(70);
    const auto a = ld_sift(mesh, keypoints_of(mesh));
    const std::size_t count = a.frames.size();
    ASSERT_GE(count, 5U);
    const auto larger = shapes::scaled(mesh, 2.5);
    const auto b = ld_sift(larger, keypoints_of(larger));
    ASSERT_EQ(b.rows.size(), a.rows.size());
    EXPECT_EQ(shapes::different_rows(a.rows, b.rows, kLdSiftLength, 1e-2), 0U);
    const Pose T_b_a = shapes::some_motion();
    const auto moved = shapes::moved(mesh, T_b_a);
    const auto c = ld_sift(moved, keypoints_of(moved));
    ASSERT_EQ(c.rows.size(), a.rows.size());
    EXPECT_EQ(shapes::different_rows(a.rows, c.rows, kLdSiftLength, 1e-2), 0U);
    for (std::size_t k = 0; k < count; ++k) {
        const Mat3f& R = a.frames[k];
        EXPECT_LE((R * R.transpose() - Mat3f::Identity()).norm(), 1e-5F);
        EXPECT_GT(R.determinant(), 0.0F);
        // Equal, or turned by half around z.
        Mat3f half = Mat3f::Identity();
        half(0, 0) = half(1, 1) = -1.0F;
        const Mat3f back = c.frames[k] * T_b_a.linear().cast<float>();
        EXPECT_LE(std::min((back - R).norm(), (half * back - R).norm()), 1e-2F);
    }
}

TEST(LdSift, RowsHaveUnitLengthAndTellShapesApart) {
    const auto mesh = shapes::landscape(70);
    const auto rows = ld_sift(mesh, keypoints_of(mesh)).rows;
    for (std::size_t a = 0; a < rows.size(); a += kLdSiftLength) {
        double squares = 0.0;
        for (std::size_t i = 0; i < kLdSiftLength; ++i) {
            EXPECT_GE(rows[a + i], 0.0F);
            squares += double{rows[a + i]} * rows[a + i];
        }
        EXPECT_NEAR(squares, 1.0, 1e-4);
        for (std::size_t b = 0; b < a; b += kLdSiftLength) {
            EXPECT_GT(shapes::relative_l1(std::span(rows).subspan(a, kLdSiftLength),
                                          std::span(rows).subspan(b, kLdSiftLength)),
                      0.02);
        }
    }
}

// A ramp along x has gradients in direction 0 only, in all squares alike but for the window.
TEST(DepthPatch, ARampFillsOneDirection) {
    DepthPatch patch;
    for (const double top : {1.0, -1.0}) {
        const Vec3d a(-2.0, -2.0, -0.4);
        const Vec3d b(2.0, -2.0, 0.4);
        const Vec3d c(2.0 * top, 2.0, 0.4 * top);
        const Vec3d d(-2.0, 2.0, -0.4);
        draw_triangle(
            top > 0.0 ? std::array<Vec3d, 3>{a, b, c} : std::array<Vec3d, 3>{b, {2.0, 2.0, 0.4}, d},
            patch);
        draw_triangle({a, {2.0, 2.0, 0.4}, d}, patch);
    }
    ASSERT_TRUE(fill_background(patch));
    for (int y = 0; y < kPatchSide; ++y) {
        for (int x = 0; x < kPatchSide; ++x) {
            EXPECT_NEAR(patch.at(x, y), 0.2 * ((2.0 * x + 1.0) / kPatchSide - 1.0), 1e-6);
        }
    }
    std::vector<float> row(kLdSiftLength, 0.0F);
    add_sift(patch, row);
    for (std::size_t b = 0; b < row.size(); ++b) {
        if (b % 8 == 0) {
            EXPECT_GT(row[b], 0.0F);
        } else {
            EXPECT_NEAR(row[b], 0.0F, 1e-4F);
        }
    }
    std::vector<float> turned(kLdSiftLength, 0.0F);
    add_sift(turned_by_half(patch), turned);
    for (std::size_t b = 0; b < row.size(); ++b) {
        if (b % 8 == 4) {
            EXPECT_NEAR(turned[b], row[128 - 8 - b / 8 * 8], 1e-4F);
        }
    }
}

TEST(DepthPatch, TheHighestSurfaceStaysAndHolesAreBackground) {
    DepthPatch patch;
    EXPECT_FALSE(fill_background(patch));
    draw_triangle({Vec3d(-1.0, -1.0, 0.3), Vec3d(1.0, -1.0, 0.3), Vec3d(-1.0, 1.0, 0.3)}, patch);
    draw_triangle({Vec3d(-1.0, -1.0, 0.1), Vec3d(-1.0, 0.0, 0.1), Vec3d(0.0, -1.0, 0.1)}, patch);
    draw_triangle({Vec3d(0.0, 0.0, 0.1), Vec3d(0.0, 0.0, 0.2), Vec3d(0.0, 0.0, 0.3)}, patch);
    EXPECT_FLOAT_EQ(patch.at(1, 1), 0.3F);
    EXPECT_TRUE(std::isinf(patch.at(20, 20)));
    ASSERT_TRUE(fill_background(patch));
    EXPECT_FLOAT_EQ(patch.at(20, 20), 0.3F);
}

TEST(ScaleInvariant, ThreadCountChangesNoBit) {
    const auto mesh = shapes::landscape(60);
    const auto keypoints = keypoints_of(mesh);
    set_thread_count(1);
    const auto sisi = describe_sisi(mesh.cloud, keypoints).rows;
    const auto sift = ld_sift(mesh, keypoints);
    set_thread_count(4);
    EXPECT_EQ(describe_sisi(mesh.cloud, keypoints).rows, sisi);
    EXPECT_EQ(ld_sift(mesh, keypoints).rows, sift.rows);
    set_thread_count(0);
}

TEST(ScaleInvariant, OddCloudsGiveFiniteRows) {
    for (const PointCloud& cloud : shapes::odd_clouds()) {
        std::vector<IndexTriangle> triangles;
        for (std::uint32_t i = 0; i + 2 < cloud.size(); ++i) triangles.push_back({i, i + 1, i + 2});
        std::vector<ScaleKeypoint> keypoints;
        for (std::uint32_t i = 0; i < cloud.size(); ++i) {
            keypoints.push_back({.index = i, .level = 3, .scale = i % 2 == 0 ? 1.0F : 1e-5F});
        }
        for (const float value : describe_sisi(cloud, keypoints).rows) {
            EXPECT_TRUE(std::isfinite(value) && value >= 0.0F && value <= 1.0F);
        }
        for (const float value : describe_ld_sift(cloud, triangles, keypoints).rows) {
            EXPECT_TRUE(std::isfinite(value) && value >= 0.0F && value <= 1.0F);
        }
    }
    // A plane's depth image is flat.
    const auto flat = shapes::height_field(20, 0.2, [](double, double) { return 0.0; });
    const std::vector<ScaleKeypoint> middle = {{.index = 210, .level = 3, .scale = 1.0F}};
    EXPECT_EQ(ld_sift(flat, middle).rows, std::vector<float>(kLdSiftLength, 0.0F));
}

TEST(ScaleInvariant, BadArgumentsAreRejected) {
    const auto mesh = shapes::landscape(10);
    const std::vector<ScaleKeypoint> good = {{.index = 50, .level = 3, .scale = 1.0F}};
    const std::vector<ScaleKeypoint> beyond = {{.index = 100, .level = 3, .scale = 1.0F}};
    const std::vector<ScaleKeypoint> no_scale = {{.index = 50}};
    for (const auto& bad : {beyond, no_scale}) {
        EXPECT_THROW(describe_sisi(mesh.cloud, bad), InvalidInput);
        EXPECT_THROW(ld_sift(mesh, bad), InvalidInput);
    }
    EXPECT_THROW(describe_sisi(mesh.cloud, good, {.support = 0.0F}), InvalidInput);
    EXPECT_THROW(describe_sisi(mesh.cloud, good, {.width = 0}), InvalidInput);
    const std::vector<IndexTriangle> bad = {{0, 1, 100}};
    EXPECT_THROW(describe_ld_sift(mesh.cloud, bad, good), InvalidInput);
    PointCloud bare = mesh.cloud;
    bare.normals.clear();
    EXPECT_THROW(describe_sisi(bare, good), InvalidInput);
}

}  // namespace
}  // namespace ostraka
