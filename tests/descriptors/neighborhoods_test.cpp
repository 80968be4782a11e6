// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/neighborhoods.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

using Row = std::tuple<float, float, float, float, float, float, float>;

std::vector<Row> sorted_rows(const Support& support) {
    std::vector<Row> rows;
    for (std::size_t i = 0; i < support.count; ++i) {
        rows.emplace_back(support.distance[i], support.x[i], support.y[i], support.z[i],
                          support.nx[i], support.ny[i], support.nz[i]);
    }
    std::sort(rows.begin(), rows.end());
    return rows;
}

// Every point, one after another, with the same float operations.
std::vector<Row> brute_force(const PointCloud& cloud, const Vec3f& keypoint, float radius) {
    Support support;
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const float x = cloud.points[i].x() - keypoint.x();
        const float y = cloud.points[i].y() - keypoint.y();
        const float z = cloud.points[i].z() - keypoint.z();
        if (x * x + y * y + z * z < radius * radius) near.push_back(i);
    }
    gather(
        cloud, keypoint, near.size(), true, [&](std::size_t i) { return near[i]; }, support);
    return sorted_rows(support);
}

void expect_brute_force(const PointCloud& cloud, float radius, std::span<const Vec3f> keypoints) {
    const Neighborhoods neighborhoods(cloud, radius, true);
    Support support;
    for (const Vec3f& keypoint : keypoints) {
        neighborhoods.find(keypoint, support);
        EXPECT_EQ(sorted_rows(support), brute_force(cloud, keypoint, radius)) << keypoint;
    }
}

std::vector<Vec3f> keypoints_in_and_around(const PointCloud& cloud) {
    std::vector<Vec3f> keypoints;
    for (std::size_t i = 0; i < cloud.size(); i += cloud.size() / 40) {
        keypoints.push_back(cloud.points[i]);
        keypoints.push_back(cloud.points[i] * 1.3F);
    }
    keypoints.emplace_back(1e6F, 0.0F, -1e6F);
    return keypoints;
}

TEST(Neighborhoods, HoldExactlyThePointsWithinTheRadius) {
    for (const PointCloud& cloud : shapes::all(1'500)) {
        for (const float radius : {0.5F, 4.0F, 15.0F, 1'000.0F}) {
            expect_brute_force(cloud, radius, keypoints_in_and_around(cloud));
        }
    }
}

TEST(Neighborhoods, FarPointsDoNotMatter) {
    PointCloud cloud = shapes::cut_torus(2'000);
    for (int i = 0; i < 20; ++i) {
        cloud.points[static_cast<std::size_t>(90 * i)] *= std::pow(4.0F, static_cast<float>(i));
    }
    expect_brute_force(cloud, 5.0F, keypoints_in_and_around(cloud));
}

TEST(Neighborhoods, CloudsFarFromTheOriginAreSearchedExactly) {
    PointCloud cloud = shapes::notched_box(1'000);
    for (Vec3f& point : cloud.points) point += Vec3f(40'000.0F, -7'000.0F, 1'000.0F);
    expect_brute_force(cloud, 8.0F, keypoints_in_and_around(cloud));
}

TEST(Neighborhoods, DegenerateCloudsAreSearched) {
    PointCloud cloud;
    cloud.points.assign(30, Vec3f(1.0F, 2.0F, 3.0F));
    cloud.normals.assign(30, Vec3f(0.0F, 0.0F, 1.0F));
    expect_brute_force(cloud, 0.1F, cloud.points);
    cloud.points.resize(1);
    cloud.normals.resize(1);
    expect_brute_force(cloud, 0.1F, cloud.points);
    const Neighborhoods nothing(PointCloud{}, 1.0F, true);
    Support support;
    nothing.find(Vec3f::Zero(), support);
    EXPECT_EQ(support.count, 0U);
}

TEST(Neighborhoods, BadArgumentsAreRejected) {
    PointCloud cloud = shapes::cut_torus(10);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<Vec3f> bad = {Vec3f(0.0F, nan, 0.0F)};
    EXPECT_NO_THROW(require_search(cloud, cloud.points, 1.0F, "test"));
    EXPECT_NO_THROW(require_search({}, cloud.points, 1.0F, "test"));
    EXPECT_THROW(require_search(cloud, bad, 1.0F, "test"), InvalidInput);
    EXPECT_THROW(require_search(cloud, {}, 0.0F, "test"), InvalidInput);
    EXPECT_THROW(require_search(cloud, {}, nan, "test"), InvalidInput);
    cloud.points[3].x() = nan;
    EXPECT_THROW(require_search(cloud, {}, 1.0F, "test"), InvalidInput);
}

TEST(CellOrder, CellsAreBoundedInNumberAndHoldEveryPointOnce) {
    PointCloud cloud = shapes::bumpy_ellipsoid(500);
    cloud.points[7] = Vec3f(1e9F, 1e9F, 1e9F);
    const CellOrder order(cloud.points, 0.01F);
    EXPECT_LE(order.cell_count(), 16U * 500U + 4'096U);
    EXPECT_EQ(order.begin(order.cell_count()), 500U);
    std::vector<std::uint32_t> indices(order.order().begin(), order.order().end());
    std::sort(indices.begin(), indices.end());
    for (std::uint32_t i = 0; i < 500; ++i) EXPECT_EQ(indices[i], i);
}

}  // namespace
}  // namespace ostraka
