// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/ray_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "mesh/test_meshes.hpp"
#include "ostraka/base/parallel.hpp"
#include "views/ray_oracle.hpp"

namespace ostraka {
namespace {

RayHit cast_one(const RayScene& scene, const Vec3d& origin, const Vec3d& direction) {
    return scene.cast(origin, std::vector<Vec3d>{direction}).front();
}

// Infinity if the ray misses. `edge`: see OracleHit.
double oracle(const TriangleMesh& mesh, const Triangle& triangle, const Vec3d& origin,
              const Vec3d& direction, double& edge) {
    const testing::OracleHit hit = testing::ray_oracle(mesh, triangle, origin, direction);
    edge = hit.edge;
    const bool hits = hit.edge >= 0.0 && hit.distance > 0.0;
    return hits ? hit.distance : std::numeric_limits<double>::infinity();
}

TEST(RayScene, AgreesWithMoellerTrumboreOnRandomTriangles) {
    const TriangleMesh mesh = test_meshes::random_triangles(60, 1);
    const RayScene scene({mesh});
    Random random(2);
    int hits = 0;
    int compared = 0;
    for (int batch = 0; batch < 100; ++batch) {
        const Vec3d origin = 3.0 * random.direction();
        std::vector<Vec3d> directions;
        for (int i = 0; i < 37; ++i) {  // not a multiple of the packet's size
            const Vec3d target(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
            directions.push_back(random.uniform(0.1, 5.0) * (target - origin));
        }
        const std::vector<RayHit> found = scene.cast(origin, directions);
        ASSERT_EQ(found.size(), directions.size());
        for (std::size_t i = 0; i < directions.size(); ++i) {
            double nearest = std::numeric_limits<double>::infinity();
            std::uint32_t expected = kNoIndex;
            double least_edge = 1.0;
            for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
                double edge = 0.0;
                const double distance =
                    oracle(mesh, mesh.triangles[t], origin, directions[i], edge);
                least_edge = std::min(least_edge, std::abs(edge));
                if (distance < nearest) {
                    nearest = distance;
                    expected = t;
                }
            }
            if (least_edge < 1e-4) continue;  // single precision may see an edge on either side
            ++compared;
            ASSERT_EQ(found[i].triangle, expected);
            ASSERT_EQ(found[i].hit(), expected != kNoIndex);
            if (!found[i].hit()) continue;
            ++hits;
            ASSERT_EQ(found[i].mesh, 0U);
            ASSERT_NEAR(found[i].distance / nearest, 1.0, 1e-9);
        }
    }
    EXPECT_GT(compared, 3000);
    EXPECT_GT(hits, 1000);
}

TEST(RayScene, DistanceToAPlaneIsExact) {
    TriangleMesh plane;
    plane.vertices = {{-100, -100, 7}, {100, -100, 7}, {0, 200, 7}};
    plane.triangles = {{0, 1, 2}};
    const RayScene scene({plane});
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        const Vec3d origin(random.uniform(-20, 20), random.uniform(-20, 20), -1.0 / 3.0);
        const Vec3d direction(random.uniform(-1, 1), random.uniform(-1, 1), 0.7);
        const RayHit hit = cast_one(scene, origin, direction);
        ASSERT_TRUE(hit.hit());
        ASSERT_NEAR(hit.distance * 0.7 / (7.0 + 1.0 / 3.0), 1.0, 1e-12);
        ASSERT_LT((scene.normal(hit) - Vec3d::UnitZ()).norm(), 1e-12);
    }
}

TEST(RayScene, BoxAgreesWithTheSlabMethod) {
    const Vec3d half(1.0, 2.0, 3.0);
    const RayScene scene({test_meshes::box(half.cast<float>())});
    Random random(4);
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3d origin = 10.0 * random.direction();
        const Vec3d target(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-4, 4));
        const Vec3d direction = target - origin;
        double enter = -std::numeric_limits<double>::infinity();
        double leave = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            const double a = (-half[axis] - origin[axis]) / direction[axis];
            const double b = (half[axis] - origin[axis]) / direction[axis];
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        if (std::abs(leave - enter) < 1e-4) continue;  // touches an edge
        const RayHit hit = cast_one(scene, origin, direction);
        ASSERT_EQ(hit.hit(), enter < leave);
        if (!hit.hit()) continue;
        ++hits;
        ASSERT_NEAR(hit.distance / enter, 1.0, 1e-9);
        ASSERT_LT(scene.normal(hit).dot(direction), 0.0) << "the entered face looks outward";
    }
    EXPECT_GT(hits, 500);
}

TEST(RayScene, SphereAgreesWithItsEquation) {
    const double radius = 5.0;
    const RayScene scene({test_meshes::sphere(radius, 120)});
    Random random(5);
    for (int i = 0; i < 500; ++i) {
        const Vec3d origin = 20.0 * random.direction();
        const Vec3d target = 0.6 * radius * random.direction();
        const Vec3d direction = (target - origin).normalized();
        const double along = -origin.dot(direction);
        const double off2 = origin.squaredNorm() - along * along;
        const double expected = along - std::sqrt(radius * radius - off2);
        const RayHit hit = cast_one(scene, origin, direction);
        ASSERT_TRUE(hit.hit());
        // Facets of 1.5 degrees lie up to radius * (1 - cos(1.06 degrees)) inside the sphere.
        ASSERT_NEAR(hit.distance, expected, 3e-3);
        const Vec3d outward = (origin + hit.distance * direction).normalized();
        ASSERT_GT(scene.normal(hit).dot(outward), std::cos(0.04));
    }
}

TEST(RayScene, NamesTheNearestOfSeveralMeshes) {
    const TriangleMesh box = test_meshes::box({1, 1, 1});
    Pose behind = Pose::Identity();
    behind.translate(Eigen::Vector3d(0, 0, 10));
    const RayScene scene({transformed(box, behind), box});
    RayHit hit = cast_one(scene, {0.1, 0.2, -5.0}, {0, 0, 1});
    EXPECT_EQ(hit.mesh, 1U);
    EXPECT_DOUBLE_EQ(hit.distance, 4.0);
    hit = cast_one(scene, {0.1, 0.2, 5.0}, {0, 0, 2});
    EXPECT_EQ(hit.mesh, 0U);
    EXPECT_DOUBLE_EQ(hit.distance, 2.0) << "in lengths of the direction";
    EXPECT_EQ(scene.mesh(1).vertices.size(), 8U);
}

TEST(RayScene, AMissIsAValue) {
    const RayScene scene({test_meshes::box({1, 1, 1})});
    const RayHit hit = cast_one(scene, {0, 0, -5}, {0, 0, -1});
    EXPECT_FALSE(hit.hit());
    EXPECT_LT(hit.distance, 0.0);
    EXPECT_TRUE(scene.cast({0, 0, -5}, {}).empty());
    const RayScene empty(std::vector<TriangleMesh>{});
    EXPECT_FALSE(cast_one(empty, {0, 0, -5}, {0, 0, 1}).hit());
}

TEST(RayScene, CanBeMoved) {
    RayScene first({test_meshes::box({1, 1, 1})});
    const RayScene second = std::move(first);
    EXPECT_TRUE(cast_one(second, {0.1, 0.2, -5.0}, {0, 0, 1}).hit());
}

TEST(RayScene, AnswersManyThreadsAtOnce) {
    const RayScene scene({test_meshes::sphere(1.0, 30)});
    const auto distance = [&](std::size_t i) {
        const Vec3d origin = 3.0 * Random(6, i).direction();
        return cast_one(scene, origin, -origin).distance;
    };
    std::vector<double> found(2000);
    parallel_for(found.size(), [&](std::size_t i) { found[i] = distance(i); });
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], distance(i));
}

}  // namespace
}  // namespace ostraka
