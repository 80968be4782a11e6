// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/model_surface.hpp"

#include <gtest/gtest.h>

#include "ostraka/views/model_views.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

PointCloud surface_of(const TriangleMesh& mesh, double spacing) {
    const MeshShape shape = measure(mesh);
    const RayScene rays({mesh});
    ViewSettings settings;
    settings.count = 20;
    settings.sampling = spacing;
    std::vector<RenderedView> views;
    for (int v = 0; v < settings.count; ++v) {
        views.push_back(render_view(rays, shape, settings, v));
    }
    return merge_surface(views, spacing);
}

TEST(MergeSurface, LeavesOutWhatIsInside) {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(-20, -20, -20), Vec3f(20, 20, 20));
    testing::add_box(mesh, Vec3f(-5, -5, -5), Vec3f(5, 5, 5));  // within the other
    for (const Vec3f& point : surface_of(mesh, 1.0).points) {
        EXPECT_NEAR(point.cwiseAbs().maxCoeff(), 20.0F, 0.6F);
    }
}

TEST(MergeSurface, NormalsPointOutwardHoweverTrianglesAreWound) {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(-20, -20, -20), Vec3f(20, 20, 20));
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
    const PointCloud surface = surface_of(mesh, 2.0);
    for (std::size_t i = 0; i < surface.size(); ++i) {
        EXPECT_GT(surface.normals[i].dot(surface.points[i]), 0.0F);
    }
}

TEST(MergeSurface, KeepsBothSidesOfAThinWall) {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(-20, -20, -0.1F), Vec3f(20, 20, 0.1F));
    std::size_t up = 0;
    std::size_t down = 0;
    const PointCloud surface = surface_of(mesh, 2.0);
    for (const Vec3f& normal : surface.normals) {
        up += normal.z() > 0.9F ? 1 : 0;
        down += normal.z() < -0.9F ? 1 : 0;
    }
    EXPECT_GT(up, 300U);
    EXPECT_GT(down, 300U);
}

}  // namespace
}  // namespace ostraka
