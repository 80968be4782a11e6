// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/triangle_mesh.hpp"

#include <gtest/gtest.h>

#include "mesh/test_meshes.hpp"
#include "simulation/closed_mesh.hpp"

namespace ostraka {
namespace {

TEST(TriangleMesh, AreaVectorIsTwiceTheAreaAlongTheNormal) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 5}, {3, 0, 5}, {0, 4, 5}};
    EXPECT_EQ(area_vector(mesh, {0, 1, 2}), Vec3d(0, 0, 12));
    EXPECT_EQ(area_vector(mesh, {0, 2, 1}), Vec3d(0, 0, -12));
    EXPECT_EQ(area_vector(mesh, {0, 1, 1}), Vec3d::Zero());
}

TEST(TriangleMesh, SurfaceAreaOfKnownShapes) {
    EXPECT_DOUBLE_EQ(surface_area(test_meshes::box({1, 2, 3})), 88.0);
    EXPECT_NEAR(surface_area(test_meshes::sphere(3.0)) / (4.0 * kPi * 9.0), 1.0, 2e-3);
    EXPECT_EQ(surface_area({}), 0.0);
}

TEST(TriangleMesh, ScaledAndTransformedActOnVertices) {
    const TriangleMesh mesh = test_meshes::lopsided(12);
    const double area = surface_area(mesh);
    EXPECT_NEAR(surface_area(scaled(mesh, 2.5)) / area, 6.25, 1e-5);
    const Pose pose = test_meshes::random_pose(2);
    const TriangleMesh moved = transformed(mesh, pose);
    EXPECT_EQ(moved.triangles, mesh.triangles);
    EXPECT_NEAR(surface_area(moved) / area, 1.0, 1e-5);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const Vec3d back = pose.inverse() * moved.vertices[i].cast<double>();
        ASSERT_LT((back - mesh.vertices[i].cast<double>()).norm(), 1e-5);
    }
}

// The other tests rely on these meshes.
TEST(TestMeshes, AreClosedAndWoundOutward) {
    for (const TriangleMesh& mesh :
         {test_meshes::box({1, 2, 3}), test_meshes::sphere(2.0, 20), test_meshes::lopsided(20)}) {
        const ClosedMeshReport report = examine(mesh);
        EXPECT_TRUE(report.closed);
        EXPECT_TRUE(report.manifold);
        EXPECT_EQ(report.components, 1);
        EXPECT_EQ(report.genus(), 0);
        EXPECT_GT(report.volume, 0.0);
    }
    EXPECT_NEAR(examine(test_meshes::box({1, 2, 3})).volume, 48.0, 1e-6);
}

}  // namespace
}  // namespace ostraka
