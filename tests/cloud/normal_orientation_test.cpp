// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/normal_orientation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "cloud/test_clouds.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/normals.hpp"

namespace ostraka {
namespace {

// Adds `count` points of a surface over the unit square, with its outward normals.
struct Sample {
    Vec3d point;
    Vec3d normal;
};
void add(PointCloud& cloud, std::size_t count, const std::function<Sample(double, double)>& surface,
         double noise = 0.0) {
    Random random(7, cloud.size());
    for (std::size_t i = 0; i < count; ++i) {
        const Sample sample = surface(random.uniform(), random.uniform());
        const Vec3d off(random.normal(), random.normal(), random.normal());
        cloud.points.push_back(Vec3d(sample.point + noise * off).cast<float>());
        cloud.normals.push_back(sample.normal.cast<float>());
    }
}

Vec3d around(double turn) {
    return {std::cos(2 * kPi * turn), std::sin(2 * kPi * turn), 0.0};
}

// A disk or ring at height z that looks up or down. Points per area: count / area.
void add_ring(PointCloud& cloud, double inner, double outer, double z, double up, double density,
              double noise = 0.0) {
    const double area = kPi * (outer * outer - inner * inner);
    add(
        cloud, static_cast<std::size_t>(area * density),
        [&](double u, double v) -> Sample {
            const double r = std::sqrt(inner * inner + u * (outer * outer - inner * inner));
            return {r * around(v) + Vec3d(0, 0, z), Vec3d(0, 0, up)};
        },
        noise);
}

void add_tube(PointCloud& cloud, double radius, double low, double high, double out, double density,
              double noise = 0.0) {
    const double area = 2 * kPi * radius * (high - low);
    add(
        cloud, static_cast<std::size_t>(area * density),
        [&](double u, double v) -> Sample {
            return {radius * around(v) + Vec3d(0, 0, low + u * (high - low)), out * around(v)};
        },
        noise);
}

// Open at the top; walls of one unit. Normals inside it look at its axis.
PointCloud cup(double density, double noise = 0.0) {
    PointCloud cloud;
    add_tube(cloud, 10, 0, 25, 1, density, noise);
    add_tube(cloud, 9, 1, 25, -1, density, noise);
    add_ring(cloud, 0, 10, 0, -1, density, noise);
    add_ring(cloud, 0, 9, 1, 1, density, noise);
    add_ring(cloud, 9, 10, 25, 1, density, noise);
    return cloud;
}

void add_box(PointCloud& cloud, const Vec3d& half, const Vec3d& center, double density,
             double noise = 0.0) {
    for (int axis = 0; axis < 3; ++axis) {
        const int next = (axis + 1) % 3;
        const int last = (axis + 2) % 3;
        const double area = 4 * half[next] * half[last];
        for (const double sign : {-1.0, 1.0}) {
            add(
                cloud, static_cast<std::size_t>(area * density),
                [&](double u, double v) {
                    Sample sample{center, Vec3d::Zero()};
                    sample.point[axis] += sign * half[axis];
                    sample.point[next] += (2 * u - 1) * half[next];
                    sample.point[last] += (2 * v - 1) * half[last];
                    sample.normal[axis] = sign;
                    return sample;
                },
                noise);
        }
    }
}

PointCloud torus(std::size_t count) {
    PointCloud cloud;
    add(cloud, count, [](double u, double v) -> Sample {
        const Vec3d normal = std::cos(2 * kPi * v) * around(u) + Vec3d(0, 0, std::sin(2 * kPi * v));
        return {10 * around(u) + 4 * normal, normal};
    });
    return cloud;
}

// The share of points whose normal is on the true side, after their normals were thrown away.
double share_right(const PointCloud& truth, OrientationResult* result = nullptr) {
    PointCloud cloud = truth;
    cloud.normals.clear();
    const OrientationResult oriented = orient_normals(cloud);
    if (result != nullptr) *result = oriented;
    std::size_t right = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        right += cloud.normals[i].dot(truth.normals[i]) > 0.0F ? 1 : 0;
    }
    return static_cast<double>(right) / static_cast<double>(cloud.size());
}

TEST(NormalOrientation, OfASphereAndATorusIsOutward) {
    EXPECT_EQ(share_right(test_clouds::sphere(3000, 10.0)), 1.0);
    EXPECT_EQ(share_right(torus(6000)), 1.0);
}

TEST(NormalOrientation, OfABoxIsOutward) {
    PointCloud box;
    add_box(box, {10, 6, 4}, {100, -50, 20}, 9.0);
    EXPECT_GT(share_right(box), 0.99);  // on its edges estimated normals may be anything
}

TEST(NormalOrientation, OfACupIsOutwardInsideToo) {
    EXPECT_GT(share_right(cup(9.0)), 0.985);
}

TEST(NormalOrientation, StandsNoise) {
    PointCloud box;
    add_box(box, {10, 6, 4}, {0, 0, 0}, 9.0, 0.5 / 3.0);  // half a spacing
    EXPECT_GT(share_right(box), 0.97);
    PointCloud ball = test_clouds::sphere(3000, 10.0);
    Random random(3);
    for (Vec3f& point : ball.points) {
        point +=
            Vec3d(0.3 * Vec3d(random.normal(), random.normal(), random.normal())).cast<float>();
    }
    EXPECT_GT(share_right(ball), 0.995);
}

TEST(NormalOrientation, KeepsTheTwoSidesOfAThinPlateApart) {
    PointCloud plate;
    add_box(plate, {20, 14, 0.5}, {0, 0, 0}, 9.0);  // three spacings thick
    EXPECT_GT(share_right(plate), 0.97);
}

TEST(NormalOrientation, OfSeveralObjectsIsThatOfEach) {
    PointCloud scene;
    add_box(scene, {5, 5, 5}, {-20, 0, 0}, 9.0);
    add_box(scene, {3, 3, 8}, {0, 3, 0}, 4.0);
    const PointCloud ball = test_clouds::sphere(2500, 8.0);
    for (std::size_t i = 0; i < ball.size(); ++i) {
        scene.points.push_back(ball.points[i] + Vec3f(20, 0, 0));
        scene.normals.push_back(ball.normals[i]);
    }
    OrientationResult result;
    EXPECT_GT(share_right(scene, &result), 0.985);
    EXPECT_GE(result.groups, 3U);
    EXPECT_EQ(result.unsure, 0U);
}

// Below the table there is nothing, and it is seen from there entirely.
TEST(NormalOrientation, OfATableIsThatOfWhatStandsOnIt) {
    PointCloud scene;
    add_box(scene, {6, 6, 5}, {0, 0, 5}, 9.0);
    PointCloud open;  // without the bottom and without the table below the box
    for (std::size_t i = 0; i < scene.size(); ++i) {
        if (scene.normals[i].z() < -0.5F) continue;
        open.points.push_back(scene.points[i]);
        open.normals.push_back(scene.normals[i]);
    }
    PointCloud table;
    add_ring(table, 0, 22, 0, 1, 9.0);
    for (std::size_t i = 0; i < table.size(); ++i) {
        if (table.points[i].head<2>().cwiseAbs().maxCoeff() < 6.0F) continue;
        open.points.push_back(table.points[i]);
        open.normals.push_back(table.normals[i]);
    }
    EXPECT_GT(share_right(open), 0.985);
}

TEST(NormalOrientation, OfAHalfShellIsItsConvexSide) {
    PointCloud shell = test_clouds::sphere(6000, 10.0);
    PointCloud half;
    for (std::size_t i = 0; i < shell.size(); ++i) {
        if (shell.points[i].z() < 0.0F) continue;
        half.points.push_back(shell.points[i]);
        half.normals.push_back(shell.normals[i]);
    }
    EXPECT_EQ(share_right(half), 1.0);
}

TEST(NormalOrientation, OfALonePlaneIsThatOfMostNormals) {
    PointCloud plane;
    plane.points = test_clouds::lattice(30, 1.0F);
    plane.normals.assign(plane.size(), Vec3f(0, 0, -1));
    for (std::size_t i = 0; i < plane.size(); i += 3) plane.normals[i] = Vec3f(0, 0, 1);
    const OrientationResult result = orient_normals(plane);
    EXPECT_EQ(result.unsure, plane.size());
    EXPECT_EQ(result.turned, plane.size() / 3);
    for (const Vec3f& normal : plane.normals) EXPECT_EQ(normal.z(), -1.0F);
}

TEST(NormalOrientation, DependsNeitherOnTheSignsBeforeNorOnThreads) {
    const PointCloud truth = cup(4.0);
    PointCloud one = truth;
    one.normals = estimate_normals(truth);
    PointCloud other = one;
    Random random(11);
    for (Vec3f& normal : other.normals) {
        if (random.below(2) == 0) normal = -normal;
    }
    set_thread_count(1);
    orient_normals(one);
    set_thread_count(4);
    orient_normals(other);
    set_thread_count(0);
    EXPECT_EQ(std::memcmp(one.normals.data(), other.normals.data(), one.size() * sizeof(Vec3f)), 0);
}

TEST(NormalOrientation, PassesOverWhatHasNoPointOrNoNormal) {
    PointCloud cloud = test_clouds::sphere(2000, 5.0);
    cloud.points[10] = test_clouds::nowhere();
    cloud.normals[20] = test_clouds::nowhere();
    cloud.normals[30] = Vec3f::Zero();
    for (std::size_t i = 0; i < cloud.size(); i += 2) cloud.normals[i] = -cloud.normals[i];
    orient_normals(cloud);
    EXPECT_TRUE(cloud.normals[20].array().isNaN().all());
    EXPECT_EQ(cloud.normals[30], Vec3f(0, 0, 0));
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (i == 10 || i == 20 || i == 30) continue;
        ASSERT_GT(cloud.normals[i].dot(cloud.points[i]), 4.9F) << i;
    }
    cloud.normals.clear();
    orient_normals(cloud);
    EXPECT_TRUE(cloud.normals[10].array().isNaN().all());
}

TEST(NormalOrientation, TakesCloudsThatAreHardlyAny) {
    PointCloud none;
    EXPECT_EQ(orient_normals(none).groups, 0U);
    PointCloud one;
    one.points = {Vec3f(1, 2, 3)};
    one.normals = {Vec3f(0, 0, 1)};
    EXPECT_EQ(orient_normals(one).turned, 0U);
    PointCloud same;
    same.points.assign(50, Vec3f(1, 2, 3));
    same.normals.assign(50, Vec3f(0, 0, 1));
    EXPECT_EQ(orient_normals(same).unsure, 50U);
    PointCloud far = test_clouds::sphere(500, 1.0);
    far.points.push_back(Vec3f(1e9F, 0, 0));
    far.normals.push_back(Vec3f(1, 0, 0));
    EXPECT_NO_THROW(orient_normals(far));
    EXPECT_THROW(orient_normals(one, {.neighbors = 0}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
