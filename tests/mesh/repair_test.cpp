// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/repair.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "mesh/test_meshes.hpp"
#include "ostraka/base/error.hpp"
#include "simulation/closed_mesh.hpp"

namespace ostraka {
namespace {

// Every triangle with its own three vertices, as an STL file has them.
TriangleMesh soup(const TriangleMesh& mesh) {
    TriangleMesh result;
    for (const Triangle& triangle : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(result.vertices.size());
        for (const std::uint32_t v : triangle) result.vertices.push_back(mesh.vertices[v]);
        result.triangles.push_back({first, first + 1, first + 2});
    }
    return result;
}

std::string message_of(const TriangleMesh& mesh) {
    try {
        repair(mesh);
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "no exception";
}

TEST(Repair, WeldsATriangleSoupIntoAClosedMesh) {
    const TriangleMesh mesh = test_meshes::lopsided(20);
    const RepairResult result = repair(soup(mesh));
    EXPECT_EQ(result.mesh.vertices.size(), mesh.vertices.size());
    EXPECT_EQ(result.welded_vertices, 3 * mesh.triangles.size() - mesh.vertices.size());
    EXPECT_EQ(result.degenerate_triangles, 0U);
    EXPECT_EQ(result.mesh.triangles.size(), mesh.triangles.size());
    const ClosedMeshReport report = examine(result.mesh);
    EXPECT_TRUE(report.closed);
    EXPECT_NEAR(report.volume, examine(mesh).volume, 1e-9);
}

TEST(Repair, LeavesASoundMeshAsItIs) {
    const TriangleMesh mesh = test_meshes::box({1, 2, 3});
    const RepairResult result = repair(mesh);
    EXPECT_EQ(result.welded_vertices, 0U);
    EXPECT_EQ(result.degenerate_triangles, 0U);
    EXPECT_DOUBLE_EQ(surface_area(result.mesh), surface_area(mesh));
    const RepairResult again = repair(result.mesh);
    EXPECT_EQ(again.mesh.vertices, result.mesh.vertices);
    EXPECT_EQ(again.mesh.triangles, result.mesh.triangles);
}

TEST(Repair, DropsDegenerateTrianglesAndUnusedVertices) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {1, 0, 0}, {9, 9, 9}};
    mesh.triangles = {{0, 1, 2},   // sound
                      {0, 1, 1},   // a repeated vertex
                      {1, 4, 2},   // the same after welding
                      {0, 1, 3}};  // on a line
    const RepairResult result = repair(mesh);
    EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_EQ(result.mesh.vertices, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(result.degenerate_triangles, 3U);
    EXPECT_EQ(result.welded_vertices, 1U);
}

TEST(Repair, KeepsTinyTriangles) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1e-6F, 0, 0}, {0, 1e-6F, 0}};
    mesh.triangles = {{0, 1, 2}};
    EXPECT_EQ(repair(mesh).mesh.triangles.size(), 1U);
}

TEST(Repair, TakesMinusZeroForZero) {
    TriangleMesh mesh;
    mesh.vertices = {{0.0F, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0F, 0, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 1}};
    EXPECT_EQ(repair(mesh).welded_vertices, 1U);
}

TEST(Repair, NamesTheFirstOffender) {
    TriangleMesh mesh = test_meshes::box({1, 1, 1});
    mesh.vertices[5].y() = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(message_of(mesh).find("vertex 5"), std::string::npos);
    mesh = test_meshes::box({1, 1, 1});
    mesh.vertices[2].z() = std::numeric_limits<float>::infinity();
    EXPECT_NE(message_of(mesh).find("vertex 2"), std::string::npos);
    mesh = test_meshes::box({1, 1, 1});
    mesh.triangles[7][1] = 8;
    EXPECT_NE(message_of(mesh).find("triangle 7"), std::string::npos);
    mesh.triangles[7][1] = kNoIndex;
    EXPECT_NE(message_of(mesh).find("triangle 7"), std::string::npos);
}

TEST(Repair, RejectsMeshesWithoutSurface) {
    EXPECT_THROW(repair({}), InvalidInput);
    TriangleMesh points;
    points.vertices = {{0, 0, 0}, {1, 0, 0}};
    EXPECT_NE(message_of(points).find("no triangles"), std::string::npos);
    TriangleMesh line;
    line.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    line.triangles = {{0, 1, 2}, {2, 1, 0}};
    EXPECT_NE(message_of(line).find("zero area"), std::string::npos);
}

}  // namespace
}  // namespace ostraka
