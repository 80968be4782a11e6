// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/keypoint_detectors.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <map>

#include "descriptors/local_testing.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

constexpr IssSettings kIss{.salient_radius = 9.0F, .non_max_radius = 6.0F};

std::vector<std::array<float, 3>> positions(const PointCloud& cloud,
                                            std::span<const std::uint32_t> indices) {
    std::vector<std::array<float, 3>> result;
    for (const std::uint32_t i : indices) {
        result.push_back({cloud.points[i].x(), cloud.points[i].y(), cloud.points[i].z()});
    }
    std::sort(result.begin(), result.end());
    return result;
}

// The definition, point by point.
std::vector<std::uint32_t> plain_iss(const PointCloud& cloud, const IssSettings& settings) {
    const auto near = [&](std::size_t a, std::size_t b, float radius) {
        return (cloud.points[a] - cloud.points[b]).squaredNorm() < radius * radius;
    };
    std::vector<double> saliency(cloud.size(), 0.0);
    std::vector<double> weight(cloud.size(), 1.0);
    for (std::size_t i = 0; i < cloud.size() && settings.paper_weights; ++i) {
        int count = 0;
        for (std::size_t j = 0; j < cloud.size(); ++j) count += near(i, j, settings.salient_radius);
        weight[i] = 1.0 / count;
    }
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
        double total = 0.0;
        int neighbors = 0;
        for (std::size_t j = 0; j < cloud.size(); ++j) {
            if (!near(i, j, settings.salient_radius)) continue;
            ++neighbors;
            const Eigen::Vector3d d = (cloud.points[j] - cloud.points[i]).cast<double>();
            scatter += weight[j] * d * d.transpose();
            total += weight[j];
        }
        if (settings.paper_weights) scatter /= total;
        const Eigen::Vector3d values =
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues();
        const bool distinctive =
            values[1] < settings.gamma_21 * values[2] && values[0] < settings.gamma_32 * values[1];
        if (neighbors >= settings.min_neighbors && distinctive) saliency[i] = values[0];
    }
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        bool largest = saliency[i] > 0.0;
        int neighbors = 0;
        for (std::size_t j = 0; j < cloud.size(); ++j) {
            if (!near(i, j, settings.non_max_radius)) continue;
            ++neighbors;
            largest = largest && saliency[j] <= saliency[i];
        }
        if (largest && neighbors >= settings.min_neighbors) kept.push_back(i);
    }
    return kept;
}

TEST(Iss, EqualsTheDefinition) {
    for (const bool paper : {false, true}) {
        IssSettings settings = kIss;
        settings.paper_weights = paper;
        for (const PointCloud& cloud : {shapes::bumpy_ellipsoid(900), shapes::cut_torus(800)}) {
            const auto keypoints = detect_iss(cloud.points, settings);
            EXPECT_GE(keypoints.size(), 10U);
            EXPECT_EQ(keypoints, plain_iss(cloud, settings));
        }
    }
}

TEST(Iss, CornersAreFoundAndPlanesAreNot) {
    EXPECT_TRUE(detect_iss(shapes::plane(30).points, {4.0F, 3.0F}).empty());
    const PointCloud tilted = transformed(shapes::plane(30), shapes::some_motion());
    EXPECT_TRUE(detect_iss(tilted.points, {4.0F, 3.0F}).empty());
    // Three faces that meet at the origin: the corner is the most salient point of all.
    PointCloud corner;
    for (int a = 0; a < 25; ++a) {
        for (int b = 0; b < 25; ++b) {
            const auto u = static_cast<float>(a);
            const auto v = static_cast<float>(b) + 0.1F;
            corner.points.emplace_back(u, v, 0.0F);
            corner.points.emplace_back(0.0F, u + 0.05F, v);
            corner.points.emplace_back(v, 0.0F, u + 0.07F);
        }
    }
    const auto keypoints = detect_iss(
        corner.points,
        {.salient_radius = 5.0F, .non_max_radius = 12.0F, .gamma_21 = 1.0, .gamma_32 = 1.0});
    const bool found = std::any_of(keypoints.begin(), keypoints.end(),
                                   [&](std::uint32_t i) { return corner.points[i].norm() < 4.0F; });
    EXPECT_TRUE(found);
}

TEST(Iss, KeypointsMoveWithTheCloud) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(3'000);
    const PointCloud moved = transformed(cloud, shapes::some_motion());
    const auto a = detect_iss(cloud.points, kIss);
    const auto b = detect_iss(moved.points, kIss);
    std::vector<std::uint32_t> common;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
    EXPECT_GE(a.size(), 20U);
    EXPECT_GE(common.size() * 20, a.size() * 19);
    EXPECT_GE(common.size() * 20, b.size() * 19);
}

TEST(Iss, ThreadCountAndOrderOfThePointsChangeNothing) {
    const PointCloud cloud = shapes::notched_box(3'000);
    set_thread_count(1);
    const auto one = detect_iss(cloud.points, kIss);
    set_thread_count(4);
    EXPECT_EQ(detect_iss(cloud.points, kIss), one);
    set_thread_count(0);
    const PointCloud other = shapes::shuffled(cloud);
    EXPECT_EQ(positions(other, detect_iss(other.points, kIss)), positions(cloud, one));
}

TEST(Iss, OddCloudsAndBadArguments) {
    for (const PointCloud& cloud : shapes::odd_clouds()) {
        for (const float radius : {1e-6F, 1.5F, 1e6F}) {
            for (const bool paper : {false, true}) {
                const IssSettings settings{
                    .salient_radius = radius, .non_max_radius = radius, .paper_weights = paper};
                EXPECT_LE(detect_iss(cloud.points, settings).size(), cloud.size());
            }
        }
    }
    EXPECT_TRUE(detect_iss({}, kIss).empty());
    const PointCloud cloud = shapes::bumpy_ellipsoid(50);
    EXPECT_THROW(detect_iss(cloud.points, {}), InvalidInput);
    EXPECT_THROW(detect_iss(cloud.points, {.salient_radius = 1.0F}), InvalidInput);
    EXPECT_THROW(detect_iss(cloud.points, {1.0F, 1.0F, -1.0}), InvalidInput);
    const std::vector<Vec3f> bad = {Vec3f::Constant(std::numeric_limits<float>::quiet_NaN())};
    EXPECT_THROW(detect_iss(bad, kIss), InvalidInput);
}

TEST(Uniform, KeepsOnePointPerCellNearestItsCenter) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(2'000);
    const float spacing = 7.0F;
    const auto keypoints = detect_uniform(cloud.points, {spacing});
    std::map<std::array<int, 3>, float> best;
    const auto place = [&](const Vec3f& p) {
        std::array<int, 3> cell;
        float square = 0.0F;
        for (int axis = 0; axis < 3; ++axis) {
            const float at = std::floor(p[axis] / spacing);
            cell[static_cast<std::size_t>(axis)] = static_cast<int>(at);
            const float off = p[axis] - (at + 0.5F) * spacing;
            square += off * off;
        }
        return std::pair(cell, square);
    };
    for (const Vec3f& p : cloud.points) {
        const auto [cell, square] = place(p);
        const auto [at, added] = best.try_emplace(cell, square);
        if (!added) at->second = std::min(at->second, square);
    }
    ASSERT_EQ(keypoints.size(), best.size());
    for (const std::uint32_t i : keypoints) {
        const auto [cell, square] = place(cloud.points[i]);
        EXPECT_NEAR(square, best[cell], 1e-3F);
    }
}

TEST(Uniform, OrderOfThePointsChangesNothing) {
    PointCloud cloud = shapes::plane(30);
    for (Vec3f& p : cloud.points) p = (2.0F * p).array().round();  // ties and duplicates
    const PointCloud other = shapes::shuffled(cloud);
    EXPECT_EQ(positions(other, detect_uniform(other.points, {4.0F})),
              positions(cloud, detect_uniform(cloud.points, {4.0F})));
}

TEST(Uniform, BadArgumentsAreRejected) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(50);
    EXPECT_TRUE(detect_uniform({}, {1.0F}).empty());
    EXPECT_THROW(detect_uniform(cloud.points, {}), InvalidInput);
    EXPECT_THROW(detect_uniform(cloud.points, {1e-12F}), InvalidInput);
    EXPECT_THROW(detect_uniform(cloud.points, {1e-42F}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
