// SPDX-License-Identifier: Apache-2.0
#include "ostraka/registration/surface_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cloud/test_clouds.hpp"
#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/cloud/kdtree.hpp"

namespace ostraka {
namespace {

TEST(SurfaceField, IsWithinACellsDiagonalOfTheNearest) {
    const double margin = 8.0;
    for (const PointCloud& surface : shapes::all(3000)) {
        const KdTree tree(surface.points);
        for (const double cell : {0.7, 1.5, 4.0}) {
            const SurfaceField field(surface, cell, margin);
            const double diagonal = std::sqrt(3.0) * cell;
            Random random(1);
            double worst = 0.0;
            for (int i = 0; i < 3000; ++i) {
                const Vec3f& near = surface.points[random.below(3000)];
                const Vec3f query =
                    near +
                    Vec3d(random.uniform(0.0, 0.99 * margin) * random.direction()).cast<float>();
                const std::uint32_t found = field.nearest(query);
                ASSERT_NE(found, kNoIndex);
                const double distance = (field.point(found) - query).cast<double>().norm();
                const double best = std::sqrt(double{tree.nearest(query).squared_distance});
                ASSERT_GE(distance, best - 1e-3);
                worst = std::max(worst, distance - best);
            }
            EXPECT_LT(worst, diagonal);
        }
    }
}

TEST(SurfaceField, KnowsPointsAndNormals) {
    const PointCloud surface = shapes::notched_box(500);
    const SurfaceField field(surface, 2.0, 5.0);
    ASSERT_EQ(field.size(), surface.size());
    for (std::uint32_t i = 0; i < 500; ++i) {
        EXPECT_EQ(field.point(i), surface.points[i]);
        EXPECT_EQ(field.normal(i), surface.normals[i]);
    }
}

TEST(SurfaceField, IsNothingBeyondItsMargin) {
    PointCloud surface = test_clouds::sphere(500, 10.0);
    const SurfaceField field(surface, 0.5, 2.0);
    EXPECT_NE(field.nearest({0, 0, 11.5F}), kNoIndex);
    EXPECT_NE(field.nearest({11.5F, -11.5F, 11.5F}), kNoIndex) << "a box, not a ball";
    for (int axis = 0; axis < 3; ++axis) {
        for (const float far : {13.0F, 1e6F, 1e12F, 1e30F, std::numeric_limits<float>::infinity(),
                                std::numeric_limits<float>::quiet_NaN()}) {
            Vec3f query = Vec3f::Zero();
            query[axis] = far;
            EXPECT_EQ(field.nearest(query), kNoIndex);
            query[axis] = -far;
            EXPECT_EQ(field.nearest(query), kNoIndex);
        }
    }
}

TEST(SurfaceField, EnlargesItsCellsRatherThanFillMemory) {
    PointCloud surface = test_clouds::sphere(200, 10.0);
    const SurfaceField solid(surface, 1e-3, 0.0);
    EXPECT_NE(solid.nearest(Vec3f::Zero()), kNoIndex);
    for (Vec3f& point : surface.points) point.z() = 0.0F;  // no volume
    const SurfaceField flat(surface, 1e-4, 0.0);
    EXPECT_NE(flat.nearest(surface.points[7]), kNoIndex);
    for (Vec3f& point : surface.points) point.y() = 0.0F;
    const SurfaceField line(surface, 1e-6, 0.0);
    EXPECT_NE(line.nearest(surface.points[7]), kNoIndex);
}

TEST(SurfaceField, OneSurfacePointIsNearestEverywhere) {
    PointCloud surface;
    surface.points = {{1, 2, 3}};
    surface.normals = {{0, 0, 1}};
    const SurfaceField field(surface, 0.25, 3.0);
    for (const Vec3f& query : test_clouds::in_box(200, 2, Vec3d::Constant(2.9), {1, 2, 3})) {
        ASSERT_EQ(field.nearest(query), 0U);
    }
}

TEST(SurfaceField, RejectsUnusableSurfaces) {
    PointCloud surface = test_clouds::sphere(10, 1.0);
    EXPECT_THROW(SurfaceField({}, 1.0, 1.0), InvalidInput);
    EXPECT_THROW(SurfaceField(surface, 0.0, 1.0), InvalidInput);
    surface.normals.clear();
    EXPECT_THROW(SurfaceField(surface, 1.0, 1.0), InvalidInput);
}

}  // namespace
}  // namespace ostraka
