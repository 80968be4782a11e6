// SPDX-License-Identifier: Apache-2.0
#include "ostraka/segmentation/plane_pieces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "segmentation/depth_scans.hpp"
#include "segmentation/partitions.hpp"

namespace ostraka {
namespace {

using test_scans::box;
using test_scans::scan;

const PatchSettings kUnit{.sampling = 1.0};
const Vec3d kEye(120, 140, 180);

std::vector<std::vector<std::uint32_t>> sets_of(const std::vector<PlanePiece>& pieces) {
    std::vector<std::vector<std::uint32_t>> sets;
    for (const PlanePiece& piece : pieces) sets.push_back(piece.indices);
    return sets;
}

// The three faces of a box of half sides (20, 12, 8), turned by 0.3 about z, that the eye sees.
void expect_box_faces(const std::vector<PlanePiece>& pieces, const Pose& T_cloud_box) {
    ASSERT_EQ(pieces.size(), 3U);
    const std::array<int, 3> axis = {2, 1,
                                     0};  // the top is the largest, the short side the smallest
    const Vec3d half(20, 12, 8);
    for (std::size_t k = 0; k < 3; ++k) {
        const PlanePiece& piece = pieces.at(k);
        const Vec3d normal = T_cloud_box.linear().col(axis.at(k));
        EXPECT_GT(piece.normal.dot(normal), std::cos(0.01)) << k;
        const Vec3d face = T_cloud_box.translation() + half[axis.at(k)] * normal;
        EXPECT_NEAR(piece.normal.dot(face), piece.offset, 0.15) << k;
        Vec2d sides(2 * half[(axis.at(k) + 1) % 3], 2 * half[(axis.at(k) + 2) % 3]);
        if (sides.x() < sides.y()) std::swap(sides.x(), sides.y());
        EXPECT_NEAR(piece.extents.x(), sides.x(), 2.0) << k;
        EXPECT_NEAR(piece.extents.y(), sides.y(), 2.0) << k;
        EXPECT_LT((piece.T_cloud_piece.translation() - face).norm(), 1.2) << k;
        EXPECT_NEAR(piece.T_cloud_piece.linear().determinant(), 1.0, 1e-6);
        EXPECT_GT(piece.T_cloud_piece.linear().col(2).dot(piece.normal), 1.0 - 1e-9);
        EXPECT_TRUE(std::is_sorted(piece.indices.begin(), piece.indices.end()));
    }
}

TEST(FindPlanes, AreTheThreeVisibleFacesOfABox) {
    const test_scans::Solid solid = box({20, 12, 8}, {0, 0, 0}, 0.3);
    for (const double noise : {0.0, 0.1, 0.2}) {
        const PointCloud cloud = scan({solid}, kEye, noise).cloud;
        const std::vector<PlanePiece> pieces = find_planes(cloud, kUnit);
        expect_box_faces(pieces, solid.T_world_solid);
        std::size_t held = 0;
        for (const PlanePiece& piece : pieces) held += piece.indices.size();
        EXPECT_GT(held, cloud.size() * 9 / 10) << "edges belong to a face";
        EXPECT_LT(pieces[0].roughness, noise + 0.05);
    }
}

TEST(FindPlanes, TurnWithTheCloud) {
    const test_scans::Solid solid = box({20, 12, 8}, {0, 0, 0}, 0.3);
    const PointCloud cloud = scan({solid}, kEye, 0.2).cloud;
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const Pose T_new_old = test_clouds::random_pose(seed, 300.0);
        expect_box_faces(find_planes(transformed(cloud, T_new_old), kUnit),
                         T_new_old * solid.T_world_solid);
    }
}

TEST(FindPlanes, ScaleWithTheCloud) {
    const PointCloud cloud = scan({box({20, 12, 8}, {0, 0, 0}, 0.3)}, kEye, 0.2).cloud;
    const auto pieces = find_planes(cloud, kUnit);
    const auto small = find_planes(scaled(cloud, 0.0009765625), {.sampling = 0.0009765625});
    EXPECT_EQ(sets_of(pieces), sets_of(small)) << "a power of two scales without rounding";
    EXPECT_NEAR(small[0].extents.x(), pieces[0].extents.x() / 1024, 1e-6);
}

TEST(FindPlanes, DoNotDependOnTheOrderOfPointsOrThreads) {
    const PointCloud cloud =
        scan({test_scans::table(40), box({10, 8, 8}, {0, 0, 8}, 0.5)}, kEye, 0.2).cloud;
    const auto pieces = find_planes(cloud, kUnit);
    ASSERT_GE(pieces.size(), 4U);
    const std::vector<std::uint32_t> order = test_scans::shuffled(cloud.size(), 5);
    set_thread_count(3);
    const auto others = find_planes(select(cloud, order), kUnit);
    set_thread_count(0);
    EXPECT_EQ(test_scans::in_original(sets_of(others), order),
              test_scans::in_original(sets_of(pieces), test_scans::all_of(cloud.size())));
    // The table's two sides are equally large: which comes first depends on indices.
    for (std::size_t k = 0; k < pieces.size(); ++k) {
        EXPECT_TRUE(std::any_of(others.begin(), others.end(), [&](const PlanePiece& other) {
            return other.normal == pieces[k].normal && other.offset == pieces[k].offset &&
                   other.extents == pieces[k].extents;
        }));
        if (k > 0) {
            EXPECT_LE(pieces[k].indices.size(), pieces[k - 1].indices.size());
        }
    }
}

TEST(FindPlanes, RejectCurvedSurfaces) {
    for (const double noise : {0.0, 0.2}) {
        for (const double radius : {6.0, 10.0, 15.0, 25.0, 40.0}) {
            const auto ball = scan({test_scans::ball(radius, {0, 0, 0})}, kEye, noise);
            EXPECT_TRUE(find_planes(ball.cloud, kUnit).empty()) << radius << " noise " << noise;
            const auto can =
                scan({test_scans::cylinder(radius, 18, {0, 0, 0}, true)}, {5, 30, 250}, noise);
            for (const PlanePiece& piece : find_planes(can.cloud, kUnit)) {
                EXPECT_GT(std::abs(piece.normal.x()), 0.99)
                    << "a cap, if it is in view; " << radius;
            }
        }
    }
}

TEST(FindPlanes, AreConnectedPieces) {
    const PointCloud cloud =
        scan({box({10, 15, 5}, {-14, 0, 0}), box({12, 15, 5}, {14, 0, 0})}, {0, 0, 250}, 0.1).cloud;
    const auto pieces = find_planes(cloud, kUnit);
    ASSERT_EQ(pieces.size(), 2U) << "tops in one plane, 6 apart";
    EXPECT_NEAR(pieces[0].offset, pieces[1].offset, 0.1);
    EXPECT_GT(pieces[0].T_cloud_piece.translation().x(), 5.0) << "the larger one first";
    EXPECT_LT(pieces[1].T_cloud_piece.translation().x(), -5.0);
}

// Two squares in one plane and a bridge between them, 4 wide, whose normals are tilted.
PointCloud bridged_squares(float tilt) {
    PointCloud cloud;
    cloud.viewpoint = Vec3f(0, 0, 100);
    for (int x = -18; x <= 18; ++x) {
        for (int y = -6; y <= 6; ++y) {
            const bool bridge = std::abs(x) < 5;
            if (bridge && (y < 0 || y > 3)) continue;
            cloud.points.emplace_back(static_cast<float>(x), static_cast<float>(y), 0.0F);
            cloud.normals.emplace_back(0.0F, bridge ? std::sin(tilt) : 0.0F,
                                       bridge ? std::cos(tilt) : 1.0F);
        }
    }
    return cloud;
}

TEST(FindPlanes, AreOneWherePointsConnectThemThoughPatchesDoNot) {
    EXPECT_EQ(find_planes(bridged_squares(0.0F), kUnit).size(), 1U);
    const auto pieces = find_planes(bridged_squares(0.35F), kUnit);
    ASSERT_EQ(pieces.size(), 1U) << "as blended as normals at an edge";
    EXPECT_NEAR(pieces[0].extents.x(), 36.0, 1e-3);
    EXPECT_EQ(find_planes(bridged_squares(0.7F), kUnit).size(), 2U);
}

TEST(FindPlanes, NormalsPointToTheViewpoint) {
    PointCloud cloud = scan({box({20, 12, 8}, {0, 0, 0})}, {0, 0, 250}, 0.1).cloud;
    ASSERT_EQ(find_planes(cloud, kUnit).size(), 1U);
    EXPECT_GT(find_planes(cloud, kUnit)[0].normal.z(), 0.99);
    cloud.viewpoint.z() = -250.0F;
    for (Vec3f& normal : cloud.normals) normal = -normal;
    EXPECT_LT(find_planes(cloud, kUnit)[0].normal.z(), -0.99);
    EXPECT_NEAR(find_planes(cloud, kUnit)[0].offset, -8.0, 0.1);
}

TEST(FindPlanes, LeaveOutInvalidAndSmall) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    PointCloud cloud = scan({box({20, 12, 8}, {0, 0, 0}, 0.3)}, kEye, 0.1).cloud;
    cloud.points[7].x() = nan;
    cloud.normals[9].z() = nan;
    const auto pieces = find_planes(cloud, kUnit);
    ASSERT_EQ(pieces.size(), 3U);
    for (const PlanePiece& piece : pieces) {
        for (const std::uint32_t i : piece.indices) EXPECT_TRUE(i != 7 && i != 9);
    }
    const auto large = find_planes(cloud, kUnit, {.min_points = pieces[1].indices.size()});
    EXPECT_EQ(large.size(), 2U);
    EXPECT_TRUE(find_planes({}, kUnit).empty());
    PointCloud one;
    one.points = {{1, 2, 3}};
    one.normals = {{0, 0, 1}};
    EXPECT_TRUE(find_planes(one, kUnit, {.min_points = 1}).empty());
    EXPECT_THROW(find_planes(one, PatchSettings{}), InvalidInput) << "no sampling";
    one.normals.clear();
    EXPECT_THROW(find_planes(one, kUnit), InvalidInput);
}

}  // namespace
}  // namespace ostraka
