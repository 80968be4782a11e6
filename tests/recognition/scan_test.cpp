// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/scan.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/resample.hpp"
#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

constexpr double kSampling = 2.0;
constexpr double kDiameter = 110.0;

PointCloud crowd(std::size_t count, double half) {
    Random random(3);
    PointCloud cloud;
    for (std::size_t i = 0; i < count; ++i) {
        cloud.points.push_back(Vec3d(random.uniform(-half, half), random.uniform(-half, half),
                                     300.0 + random.uniform(-half, half))
                                   .cast<float>());
    }
    return cloud;
}

void expect_rejected(const PointCloud& cloud, const std::string& word) {
    try {
        prepare_scan(cloud, kSampling, kDiameter, {});
        FAIL() << "accepted; expected a complaint about: " << word;
    } catch (const InvalidInput& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find(word), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

TEST(PrepareScan, BringsTheScanToTheSamplingDistanceWithNormalsTowardTheSensor) {
    const SimulatedScene scene = tabletop({kCorner, kPlate}, 0);
    const Scan scan = prepare_scan(scene.cloud, kSampling, kDiameter, {});
    EXPECT_NEAR(mesh_resolution(scan.cloud.points), kSampling, 0.35 * kSampling);
    ASSERT_EQ(scan.cloud.normals.size(), scan.cloud.size());
    for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
        ASSERT_NEAR(scan.cloud.normals[i].norm(), 1.0F, 1e-4F);
        ASSERT_LE(scan.cloud.normals[i].dot(scan.cloud.points[i]), 1e-3F);
    }
    EXPECT_EQ(scan.sampling, kSampling);
    EXPECT_EQ(scan.plane_extents.size(), scan.cloud.size());
}

TEST(PrepareScan, FindsTheTableAndLeavesTheObjectsInFront) {
    for (std::uint64_t number = 0; number < 5; ++number) {
        const SimulatedScene scene = tabletop({kCorner, kPlate}, number);
        const Scan scan = prepare_scan(scene.cloud, kSampling, kDiameter, {});
        ASSERT_TRUE(scan.table);
        // Every labeled point well above the table is foreground, and no point of the table is.
        std::size_t on_table = 0;
        for (std::size_t i = 0; i < scene.labels.size(); ++i) {
            const Vec3f& point = scene.cloud.points[i];
            if (scene.labels[i] != kNoIndex || !point.allFinite()) continue;
            ++on_table;
            const double height = scan.table->normal.dot(point.cast<double>()) - scan.table->offset;
            ASSERT_LT(std::abs(height), 0.5 * kSampling);
        }
        ASSERT_GT(on_table, 1000U);
        EXPECT_LT(scan.table->offset, 0.0);  // the normal faces the sensor at the origin
        for (const Vec3f& point : scan.cloud.points) {
            const double height = scan.table->normal.dot(point.cast<double>()) - scan.table->offset;
            ASSERT_GE(height, 0.9 * kSampling);
        }
        EXPECT_GT(scan.cloud.size(), 300U);
        EXPECT_LT(scan.cloud.size(), resample(scene.cloud, kSampling).size() / 2);
    }
}

TEST(PrepareScan, ALargeFaceOfAModelIsNoTable) {
    const Scan scan = prepared(alone(kPlate, 5));
    EXPECT_FALSE(scan.table);
    EXPECT_GT(scan.cloud.size(), 500U);
}

// Its top is 1.4 sampling distances above the table: as far as a piece of table might seem to be.
TEST(PrepareScan, AThinSheetOnATableIsNoPieceOfIt) {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(-300, -300, -20), Vec3f(300, 300, 0));
    testing::add_box(mesh, Vec3f(-45, -25, 0), Vec3f(45, 25, 2.8F));
    for (const double noise : {0.0, 0.4}) {
        const SimulatedScene scene = scan_of(mesh, Vec3d(60, -250, 400), noise);
        const Scan scan = prepare_scan(scene.cloud, kSampling, kDiameter, {});
        ASSERT_TRUE(scan.table) << noise;
        const Pose T_world_scan = scene.objects[0].T_scene_model.inverse();
        std::size_t on_sheet = 0;
        for (const Vec3f& point : scan.cloud.points) {
            const Vec3d at = T_world_scan * point.cast<double>();
            on_sheet += std::abs(at.x()) < 45.0 && std::abs(at.y()) < 25.0 ? 1U : 0U;
        }
        const double all = 90.0 * 50.0 / (kSampling * kSampling);
        EXPECT_GT(static_cast<double>(on_sheet), 0.8 * all) << noise;
    }
}

TEST(PrepareScan, KeepsTheTableWhereAskedTo) {
    const SimulatedScene scene = tabletop({kCorner}, 0);
    const Scan scan = prepare_scan(scene.cloud, kSampling, kDiameter, {.remove_plane = false});
    EXPECT_FALSE(scan.table);
    EXPECT_GT(scan.cloud.size(), resample(scene.cloud, kSampling).size() * 9 / 10);
}

TEST(PrepareScan, InvalidPointsChangeNothing) {
    const SimulatedScene scene = tabletop({kCorner}, 1);
    PointCloud cloud = remove_invalid(scene.cloud);
    const Scan before = prepare_scan(cloud, kSampling, kDiameter, {});
    cloud.points.insert(cloud.points.begin(), 1000, Vec3f::Constant(std::nanf("")));
    cloud.points.insert(cloud.points.begin(), 10, Vec3f(1.0F, INFINITY, 0.0F));
    const Scan after = prepare_scan(cloud, kSampling, kDiameter, {});
    EXPECT_EQ(before.cloud.points, after.cloud.points);
}

TEST(PrepareScan, SaysWhatIsWrong) {
    PointCloud cloud = crowd(3, 40.0);
    expect_rejected({}, "0 finite points");
    expect_rejected(cloud, "3 finite points");
    cloud.points.assign(500, Vec3f::Constant(std::nanf("")));
    expect_rejected(cloud, "0 finite points of 500");
    cloud.points.assign(500, Vec3f(1.0F, 2.0F, 3.0F));
    expect_rejected(cloud, "coincide");
    expect_rejected(crowd(5000, 100'000.0), "unit");
    expect_rejected(crowd(5000, 0.1), "unit");
    expect_rejected(crowd(500, 0.9), "at least 10");  // fits, but in a few cells
}

}  // namespace
}  // namespace ostraka
