// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/simplify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <vector>

#include "ostraka/base/error.hpp"
#include "simulation/closed_mesh.hpp"

namespace ostraka {
namespace {

// A cube of side 2 around the origin with n x n squares a face.
TriangleMesh cube(int n) {
    TriangleMesh mesh;
    std::map<std::array<int, 3>, std::uint32_t> seen;
    const auto vertex = [&](const std::array<int, 3>& at) {
        const auto [found, is_new] =
            seen.try_emplace(at, static_cast<std::uint32_t>(mesh.vertices.size()));
        if (is_new)
            mesh.vertices.push_back(Vec3f(at[0], at[1], at[2]) * (2.0F / n) - Vec3f::Ones());
        return found->second;
    };
    for (int axis = 0; axis < 3; ++axis) {
        for (int end = 0; end < 2; ++end) {
            for (int item = 0; item < n * n; ++item) {
                const auto at = [&](int i, int j) {
                    std::array<int, 3> p{};
                    p[axis] = end * n;
                    p[(axis + 1) % 3] = item % n + i;
                    p[(axis + 2) % 3] = item / n + j;
                    return vertex(p);
                };
                const std::uint32_t a = at(0, 0);
                const std::uint32_t b = at(1, 0);
                const std::uint32_t c = at(1, 1);
                const std::uint32_t d = at(0, 1);
                mesh.triangles.push_back(end == 1 ? Triangle{a, b, c} : Triangle{a, c, b});
                mesh.triangles.push_back(end == 1 ? Triangle{a, c, d} : Triangle{a, d, c});
            }
        }
    }
    return mesh;
}

TriangleMesh ball(int n, float radius) {
    TriangleMesh mesh = cube(n);
    for (Vec3f& v : mesh.vertices) v = v.normalized() * radius;
    return mesh;
}

TriangleMesh ring(int around, int across, double big, double small) {
    TriangleMesh mesh;
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            const double u = 2.0 * kPi * i / around;
            const double v = 2.0 * kPi * j / across;
            const double r = big + small * std::cos(v);
            mesh.vertices.push_back(
                Vec3d(r * std::cos(u), r * std::sin(u), small * std::sin(v)).cast<float>());
            const auto at = [&](int a, int b) {
                return static_cast<std::uint32_t>((a % around) * across + b % across);
            };
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

void expect_sound(const TriangleMesh& mesh, int genus) {
    const ClosedMeshReport report = examine(mesh);
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(report.manifold);
    EXPECT_EQ(report.components, 1);
    EXPECT_EQ(report.genus(), genus);
    EXPECT_EQ(report.folds, 0);
    EXPECT_EQ(report.empty_triangles, 0);
}

TEST(Simplify, ACubeBecomesTwelveTriangles) {
    const TriangleMesh mesh = simplify(cube(20), {.max_error = 1e-3});
    EXPECT_EQ(mesh.triangles.size(), 12U);
    expect_sound(mesh, 0);
    EXPECT_NEAR(examine(mesh).volume, 8.0, 1e-3);
    EXPECT_NEAR(surface_area(mesh), 24.0, 1e-3);
}

TEST(Simplify, AnEighthOfTheErrorCostsEightTimesTheTriangles) {
    const std::size_t rough = simplify(ball(60, 10.0F), {.max_error = 0.16}).triangles.size();
    const std::size_t fine = simplify(ball(60, 10.0F), {.max_error = 0.02}).triangles.size();
    EXPECT_GT(fine, 4 * rough);
    EXPECT_LT(fine, 16 * rough);
}

TEST(Simplify, ASphereStaysWithinTheErrorOnBothSides) {
    const TriangleMesh input = ball(50, 10.0F);
    const double error = 0.05;
    const TriangleMesh mesh = simplify(input, {.max_error = error});
    expect_sound(mesh, 0);
    EXPECT_LT(mesh.triangles.size(), input.triangles.size() / 8);
    for (const Vec3f& v : mesh.vertices) EXPECT_NEAR(v.norm(), 10.0, 2.0 * error);
    // The nearest point of the result to any input vertex, by brute force over dense samples.
    std::vector<Vec3d> samples;
    constexpr int kSteps = 24;
    for (const Triangle& t : mesh.triangles) {
        for (int i = 0; i <= kSteps; ++i) {
            for (int j = 0; i + j <= kSteps; ++j) {
                const double u = static_cast<double>(i) / kSteps;
                const double v = static_cast<double>(j) / kSteps;
                samples.push_back((1.0 - u - v) * mesh.vertices[t[0]].cast<double>() +
                                  u * mesh.vertices[t[1]].cast<double>() +
                                  v * mesh.vertices[t[2]].cast<double>());
            }
        }
    }
    for (std::size_t i = 0; i < input.vertices.size(); i += 37) {
        double nearest = 1e9;
        for (const Vec3d& s : samples) {
            nearest = std::min(nearest, (s - input.vertices[i].cast<double>()).norm());
        }
        // Samples lie up to about 0.07 apart on a face.
        EXPECT_LT(nearest, std::hypot(error, 0.07));
    }
}

TEST(Simplify, ATorusKeepsItsHole) {
    const TriangleMesh mesh = simplify(ring(80, 40, 10.0, 3.0), {.max_error = 0.1});
    expect_sound(mesh, 1);
    EXPECT_LT(mesh.triangles.size(), 1600U);
    EXPECT_NEAR(examine(mesh).volume / (2.0 * kPi * kPi * 10.0 * 9.0), 1.0, 0.02);
    // Even if everything may go.
    expect_sound(simplify(ring(80, 40, 10.0, 3.0), {.max_error = 100.0}), 1);
}

TEST(Simplify, StopsAtTheLeastNumberOfTriangles) {
    const TriangleMesh mesh = simplify(ball(20, 1.0F), {.max_error = 10.0, .min_triangles = 500});
    EXPECT_LE(mesh.triangles.size(), 500U);
    EXPECT_GE(mesh.triangles.size(), 498U);
}

TEST(Simplify, IsTheSameTwice) {
    const TriangleMesh a = simplify(ring(60, 30, 5.0, 2.0), {.max_error = 0.03});
    const TriangleMesh b = simplify(ring(60, 30, 5.0, 2.0), {.max_error = 0.03});
    EXPECT_EQ(a.triangles, b.triangles);
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    EXPECT_EQ(std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vec3f)),
              0);
}

TEST(Simplify, RejectsOpenAndBrokenMeshes) {
    TriangleMesh open = cube(2);
    open.triangles.pop_back();
    EXPECT_THROW(simplify(open), InvalidInput);
    TriangleMesh turned = cube(2);
    std::swap(turned.triangles[0][0], turned.triangles[0][1]);
    EXPECT_THROW(simplify(turned), InvalidInput);
    TriangleMesh range = cube(2);
    range.triangles[0][0] = 999;
    EXPECT_THROW(simplify(range), InvalidInput);
    TriangleMesh pinched = cube(2);  // two cubes that share one vertex
    const auto offset = static_cast<std::uint32_t>(pinched.vertices.size());
    const TriangleMesh second = cube(2);
    for (const Vec3f& v : second.vertices) pinched.vertices.push_back(v + Vec3f::Constant(2.0F));
    for (const Triangle& t : second.triangles) {
        Triangle shared{};
        for (int k = 0; k < 3; ++k) {
            const bool corner = (second.vertices[t[k]] + Vec3f::Ones()).norm() < 1e-6F;
            shared[k] = t[k] + offset;
            if (!corner) continue;
            for (std::uint32_t v = 0; v < offset; ++v) {
                if ((pinched.vertices[v] - Vec3f::Ones()).norm() < 1e-6F) shared[k] = v;
            }
        }
        pinched.triangles.push_back(shared);
    }
    EXPECT_THROW(simplify(pinched), InvalidInput);
    EXPECT_THROW(simplify(cube(2), {.max_error = 0.0}), InvalidInput);
}

}  // namespace
}  // namespace ostraka
