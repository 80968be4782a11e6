// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/scale_keypoints.hpp"

#include <gtest/gtest.h>

#include "descriptors/bumpy_meshes.hpp"
#include "descriptors/local_testing.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

std::vector<ScaleKeypoint> keypoints_of(const shapes::Mesh& mesh,
                                        const ScaleKeypointSettings& settings = {}) {
    return detect_scale_keypoints(mesh.cloud, mesh.triangles, settings);
}

const ScaleKeypoint& strongest(std::span<const ScaleKeypoint> keypoints) {
    return *std::max_element(keypoints.begin(), keypoints.end(),
                             [](const auto& a, const auto& b) { return a.response < b.response; });
}

// Averaging closed rings of six spreads a variance of 3/7 a step along each axis, so after k steps
// a bump of deviation s has the height s^2 / (s^2 + t), t = 3k/7. Its motion times k is largest at
// t = s^2: at level 7/3 s^2.
TEST(ScaleKeypoints, ABumpIsFoundAtItsPlaceAndScale) {
    for (const double deviation : {1.6, 2.0, 2.5}) {
        const auto mesh = shapes::height_field(
            60, 0.02, [&](double x, double y) { return 0.5 * shapes::gaussian(x, y, deviation); });
        const auto keypoints = keypoints_of(mesh, {.levels = 30});
        ASSERT_FALSE(keypoints.empty());
        const ScaleKeypoint& best = strongest(keypoints);
        EXPECT_LE(mesh.cloud.points[best.index].head<2>().norm(), 1.0F);
        const double level = 7.0 / 3.0 * deviation * deviation;
        EXPECT_NEAR(best.level, level, 0.15 * level + 1.0);
        EXPECT_NEAR(best.scale, std::sqrt(best.level), 0.05 * best.scale);
        // k x motion at its peak: k (3/7) s^2 / (2 s^2)^2 = 1/4 of the height.
        EXPECT_NEAR(best.response, 0.25 * 0.5, 0.02);
    }
}

TEST(ScaleKeypoints, PlanesHaveNone) {
    const auto flat = shapes::height_field(40, 0.2, [](double, double) { return 0.0; });
    EXPECT_TRUE(keypoints_of(flat, {.contrast = 1e-3F}).empty());
    EXPECT_TRUE(keypoints_of(flat, {.contrast = 1e-3F, .keep_borders = true}).empty());
    const auto tilted = shapes::moved(flat, shapes::some_motion());
    EXPECT_TRUE(keypoints_of(tilted, {.contrast = 1e-3F, .keep_borders = true}).empty());
    const auto slope =
        shapes::height_field(40, 0.2, [](double x, double y) { return 0.4 * x + 0.2 * y; });
    EXPECT_TRUE(keypoints_of(slope, {.contrast = 1e-3F, .keep_borders = true}).empty());
}

TEST(ScaleKeypoints, ScalingTheSurfaceScalesThem) {
    const auto mesh = shapes::landscape(70);
    const auto a = keypoints_of(mesh);
    EXPECT_GE(a.size(), 5U);
    for (const double factor : {2.5, 1e-3}) {
        const auto b = keypoints_of(shapes::scaled(mesh, factor));
        ASSERT_EQ(b.size(), a.size());
        for (std::size_t k = 0; k < a.size(); ++k) {
            EXPECT_EQ(b[k].index, a[k].index);
            EXPECT_EQ(b[k].level, a[k].level);
            EXPECT_NEAR(b[k].scale / a[k].scale, factor, 1e-5 * factor);
            EXPECT_NEAR(b[k].response, a[k].response, 1e-4F);
        }
    }
}

TEST(ScaleKeypoints, AMotionChangesNothing) {
    const auto mesh = shapes::landscape(70);
    const auto a = keypoints_of(mesh);
    const auto b = keypoints_of(shapes::moved(mesh, shapes::some_motion()));
    ASSERT_EQ(b.size(), a.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
        EXPECT_EQ(b[k].index, a[k].index);
        EXPECT_EQ(b[k].level, a[k].level);
        EXPECT_NEAR(b[k].scale, a[k].scale, 1e-5F * a[k].scale);
    }
}

TEST(ScaleKeypoints, BordersAreLeftOut) {
    // Half of a bump: its top lies on the border.
    const auto mesh = shapes::height_field(40, 0.02, [](double x, double y) {
        return 2.0 * shapes::gaussian(x, y + 20.0 * std::sqrt(0.75), 2.0);
    });
    const auto inner = keypoints_of(mesh);
    const auto all = keypoints_of(mesh, {.keep_borders = true});
    EXPECT_GT(all.size(), inner.size());
    for (const ScaleKeypoint& keypoint : inner) {
        EXPECT_GT(mesh.cloud.points[keypoint.index].y(), -20.0 * std::sqrt(0.75) + 1.0);
    }
}

// Other triangles than the mesh' own, but the same features.
TEST(ScaleKeypoints, WorkOnATriangulatedCloud) {
    const auto mesh = shapes::landscape(70);
    const auto own = keypoints_of(mesh, {.contrast = 0.2F});
    const auto other =
        detect_scale_keypoints(mesh.cloud, triangulate(mesh.cloud), {.contrast = 0.15F});
    EXPECT_GE(own.size(), 4U);
    for (const ScaleKeypoint& a : own) {
        const bool found = std::any_of(other.begin(), other.end(), [&](const ScaleKeypoint& b) {
            const Vec3f offset = mesh.cloud.points[a.index] - mesh.cloud.points[b.index];
            return offset.norm() < 1.5F && std::abs(a.scale - b.scale) < 0.15F * a.scale;
        });
        EXPECT_TRUE(found) << a.index << " level " << a.level << " response " << a.response;
    }
}

TEST(ScaleKeypoints, ThreadCountChangesNoBit) {
    const auto mesh = shapes::landscape(50);
    set_thread_count(1);
    const auto one = keypoints_of(mesh);
    set_thread_count(4);
    const auto many = keypoints_of(mesh);
    set_thread_count(0);
    ASSERT_EQ(one.size(), many.size());
    for (std::size_t k = 0; k < one.size(); ++k) {
        EXPECT_EQ(one[k].index, many[k].index);
        EXPECT_EQ(one[k].scale, many[k].scale);
        EXPECT_EQ(one[k].response, many[k].response);
    }
}

TEST(ScaleKeypoints, OddCloudsAndBadArguments) {
    for (const PointCloud& cloud : shapes::odd_clouds()) {
        std::vector<IndexTriangle> triangles;
        for (std::uint32_t i = 0; i + 2 < cloud.size(); ++i) triangles.push_back({i, i + 1, i + 2});
        triangles.push_back({0, 0, 0});
        for (const auto& keypoint :
             detect_scale_keypoints(cloud, triangles, {.contrast = 0.0F, .keep_borders = true})) {
            EXPECT_TRUE(std::isfinite(keypoint.scale) && keypoint.scale > 0.0F);
            EXPECT_TRUE(std::isfinite(keypoint.response));
        }
        EXPECT_TRUE(detect_scale_keypoints(cloud, {}).empty());
    }
    EXPECT_TRUE(detect_scale_keypoints(PointCloud{}, {}).empty());
    const auto mesh = shapes::landscape(10);
    EXPECT_THROW(keypoints_of(mesh, {.levels = 2}), InvalidInput);
    EXPECT_THROW(keypoints_of(mesh, {.contrast = -1.0F}), InvalidInput);
    const std::vector<IndexTriangle> bad = {{0, 1, 100}};
    EXPECT_THROW(detect_scale_keypoints(mesh.cloud, bad), InvalidInput);
    PointCloud bare = mesh.cloud;
    bare.normals.clear();
    EXPECT_THROW(detect_scale_keypoints(bare, mesh.triangles), InvalidInput);
}

}  // namespace
}  // namespace ostraka
