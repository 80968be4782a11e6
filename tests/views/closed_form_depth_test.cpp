// SPDX-License-Identifier: Apache-2.0
// Simulated depth against geometry that can be worked out on paper.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "mesh/test_meshes.hpp"
#include "ostraka/views/render.hpp"
#include "views/ray_oracle.hpp"

namespace ostraka {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const PinholeCamera kCamera{160, 120, 150.0, 140.0, 78.3, 61.7};

// The ray parameter where a surface is first met; infinity: nowhere. Model frame.
using Meets = std::function<double(const Vec3d& origin, const Vec3d& direction)>;

// The depth that a pixel must show of a model placed by T_camera_model.
double expected_depth(const Meets& meets, const Pose& T_camera_model, int u, int v) {
    const Pose T_model_camera = T_camera_model.inverse();
    return meets(T_model_camera.translation(), T_model_camera.linear() * kCamera.ray(u, v));
}

struct Deviation {
    double greatest = 0.0;     // of a depth, relative
    std::size_t seen = 0;      // pixels with a depth in both
    std::size_t one_only = 0;  // in one of both
};

Deviation compare(const PointCloud& cloud, const Meets& meets, const Pose& T_camera_model) {
    Deviation deviation;
    for (int v = 0; v < kCamera.height; ++v) {
        for (int u = 0; u < kCamera.width; ++u) {
            const Vec3f& point = cloud.points[static_cast<std::size_t>(v * kCamera.width + u)];
            const double expected = expected_depth(meets, T_camera_model, u, v);
            if (std::isfinite(expected) != point.allFinite()) ++deviation.one_only;
            if (!std::isfinite(expected) || !point.allFinite()) continue;
            ++deviation.seen;
            const Vec3d exact = expected * kCamera.ray(u, v);
            deviation.greatest =
                std::max(deviation.greatest, (point.cast<double>() - exact).norm() / exact.norm());
        }
    }
    return deviation;
}

// Nothing is lost to grazing: closed forms hold for all rays.
SensorModel ideal() {
    SensorModel sensor;
    sensor.ranging.max_grazing_angle = sensor.free_grazing_angle = kPi / 2.0;
    return sensor;
}

// The same model seen both ways: as a mesh moved into the world, and placed by a pose.
std::array<PointCloud, 2> both_ways(const TriangleMesh& mesh, const Pose& T_world_model,
                                    const Pose& T_camera_world) {
    const RayScene moved({transformed(mesh, T_world_model)});
    const RayScene placed(std::vector<PlacedRayModel>{{RayModel(mesh), T_world_model}});
    return {render(moved, kCamera, T_camera_world, ideal()).cloud,
            render(placed, kCamera, T_camera_world, ideal()).cloud};
}

// A random rotation at a place that the camera sees, the world being anything.
Pose random_camera_pose(Random& random, double distance) {
    Pose T_camera_model = Pose::Identity();
    T_camera_model.linear() = random.rotation();
    T_camera_model.translation() =
        Vec3d(random.uniform(-10, 10), random.uniform(-10, 10), distance);
    return T_camera_model;
}

// Moved meshes have vertices rounded to floats: of 100 from the world's origin by 4e-6 at most,
// which a slanted face turns into some more of depth. Placed ones are exact but for the cloud.
constexpr double kMovedTolerance = 3e-6;
constexpr double kPlacedTolerance = 1e-7;

// Both views of random poses against the closed form. `edge_pixels`: rays that may meet the outline
// on either side of it. `sag`: how far the mesh may lie inside the surface, relative to the depth.
void expect_closed_form(const TriangleMesh& mesh, const Meets& meets, double distance,
                        std::size_t edge_pixels, double sag = 0.0) {
    Random random(11);
    double greatest = 0.0;
    for (int i = 0; i < 20; ++i) {
        const Pose T_camera_model = random_camera_pose(random, distance);
        const Pose T_camera_world = test_meshes::random_pose(100U + static_cast<unsigned>(i), 50.0);
        const Pose T_world_model = T_camera_world.inverse() * T_camera_model;
        const auto clouds = both_ways(mesh, T_world_model, T_camera_world);
        const Deviation moved = compare(clouds[0], meets, T_camera_model);
        const Deviation placed = compare(clouds[1], meets, T_camera_model);
        EXPECT_GT(placed.seen, 1000U) << i;
        EXPECT_LE(moved.greatest, kMovedTolerance + sag) << i;
        EXPECT_LE(placed.greatest, kPlacedTolerance + sag) << i;
        EXPECT_LE(moved.one_only, edge_pixels) << i;
        EXPECT_LE(placed.one_only, edge_pixels) << i;
        greatest = std::max({greatest, moved.greatest, placed.greatest});
        // Both ways agree with each other whatever the closed form says.
        std::size_t apart = 0;
        for (std::size_t p = 0; p < clouds[0].size(); ++p) {
            const Vec3d a = clouds[0].points[p].cast<double>();
            const Vec3d b = clouds[1].points[p].cast<double>();
            if (a.allFinite() != b.allFinite()) {
                ++apart;
            } else if (a.allFinite()) {
                ASSERT_LE((a - b).norm() / b.norm(), kMovedTolerance + sag) << i << " " << p;
            }
        }
        EXPECT_LE(apart, 2U) << i;
    }
    ::testing::Test::RecordProperty("greatest", std::to_string(greatest));
}

double meets_box(const Vec3d& half, const Vec3d& origin, const Vec3d& direction) {
    double enter = -kInfinity;
    double leave = kInfinity;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (-half[axis] - origin[axis]) / direction[axis];
        const double b = (half[axis] - origin[axis]) / direction[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter < leave ? enter : kInfinity;
}

TEST(ClosedFormDepth, OfATiltedPlaneInAllPixels) {
    TriangleMesh square;
    square.vertices = {Vec3f(-1e4F, -1e4F, 0), Vec3f(1e4F, -1e4F, 0), Vec3f(1e4F, 1e4F, 0),
                       Vec3f(-1e4F, 1e4F, 0)};
    square.triangles = {{0, 1, 2}, {0, 2, 3}};
    Random random(1);
    for (int i = 0; i < 20; ++i) {
        Pose T_camera_model = random_camera_pose(random, 100.0);
        // Tilted by up to 50 degrees: it is before all pixels.
        const Eigen::AngleAxisd tilt(random.uniform(0.0, 0.87),
                                     Vec3d(random.normal(), random.normal(), 0.0).normalized());
        T_camera_model.linear() = tilt.toRotationMatrix();
        const RayScene scene(std::vector<PlacedRayModel>{{RayModel(square), T_camera_model}});
        const RenderedView view = render(scene, kCamera, Pose::Identity(), ideal());
        const Vec3d normal = T_camera_model.linear().col(2);
        const double offset = normal.dot(T_camera_model.translation());
        for (std::size_t p = 0; p < view.cloud.size(); ++p) {
            const Vec3d ray =
                kCamera.ray(static_cast<double>(p % 160), static_cast<double>(p / 160));
            const double depth = offset / normal.dot(ray);
            ASSERT_NEAR(view.cloud.points[p].z() / depth, 1.0, kPlacedTolerance) << i << " " << p;
            // The normal faces the sensor.
            ASSERT_LT((view.normals[p].cast<double>() + normal).norm(), 1e-6);
        }
    }
}

TEST(ClosedFormDepth, OfABox) {
    const Vec3d half(30.0, 20.0, 25.0);
    expect_closed_form(
        test_meshes::box(half.cast<float>()),
        [&](const Vec3d& origin, const Vec3d& direction) {
            return meets_box(half, origin, direction);
        },
        100.0, 2);
}

// A sphere of 20 * 4^levels triangles, all about equal.
TriangleMesh icosphere(double radius, int levels) {
    const double g = (1.0 + std::sqrt(5.0)) / 2.0;
    std::vector<Vec3d> points = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                 {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                 {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    std::vector<Triangle> triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                       {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                       {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                       {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [found, is_new] =
                middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
            if (is_new) points.push_back(points[a].normalized() + points[b].normalized());
            return found->second;
        };
        std::vector<Triangle> finer;
        for (const auto& [a, b, c] : triangles) {
            const std::uint32_t ab = middle(a, b);
            const std::uint32_t bc = middle(b, c);
            const std::uint32_t ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        triangles = finer;
    }
    TriangleMesh mesh;
    for (const Vec3d& point : points) {
        mesh.vertices.push_back(Vec3d(radius * point.normalized()).cast<float>());
    }
    mesh.triangles = triangles;
    return mesh;
}

TEST(ClosedFormDepth, OfASphereWithinItsTessellation) {
    const double radius = 30.0;
    const TriangleMesh mesh = icosphere(radius, 6);
    // How deep the middle of a triangle lies inside the sphere.
    double sag = 0.0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3d middle =
            (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]).cast<double>() / 3.0;
        sag = std::max(sag, radius - middle.norm());
    }
    EXPECT_LT(sag, 0.003);
    // A ray sees the facet between the spheres of radius and radius - sag, so depths of pixels that
    // meet the inner one are bounded from both sides; the few that don't are at the outline.
    Random random(12);
    for (int i = 0; i < 20; ++i) {
        const Pose T_camera_model = random_camera_pose(random, 100.0);
        const Pose T_camera_world = test_meshes::random_pose(200U + static_cast<unsigned>(i), 50.0);
        std::size_t seen = 0;
        for (const PointCloud& cloud :
             both_ways(mesh, T_camera_world.inverse() * T_camera_model, T_camera_world)) {
            for (std::size_t p = 0; p < cloud.size(); ++p) {
                const Vec3d ray =
                    kCamera.ray(static_cast<double>(p % 160), static_cast<double>(p / 160));
                const Vec3d center = T_camera_model.translation();
                const double along = center.dot(ray) / ray.squaredNorm();
                const double off2 = (along * ray - center).squaredNorm();
                const auto depth = [&](double r) {
                    return r * r > off2 ? along - std::sqrt((r * r - off2) / ray.squaredNorm())
                                        : kInfinity;
                };
                const bool hit = cloud.points[p].allFinite();
                if (depth(radius + 1e-4) == kInfinity) {
                    ASSERT_FALSE(hit);
                }
                if (depth(radius - sag - 1e-4) == kInfinity) continue;
                ASSERT_TRUE(hit);
                ++seen;
                const double z = cloud.points[p].z();
                ASSERT_GE(z, depth(radius) * (1.0 - kMovedTolerance)) << i << " " << p;
                ASSERT_LE(z, depth(radius - sag - 1e-5) * (1.0 + kMovedTolerance)) << i << " " << p;
            }
        }
        EXPECT_GT(seen, 5000U);
    }
}

// The nearest crossing of a segment with triangles, 0 to 1 along it; `edge`: how near to an edge of
// some triangle the segment passes.
struct Crossing {
    bool hidden = false;
    bool unclear = false;  // rounding may decide either way
};

Crossing crossing(const TriangleMesh& mesh, const Vec3d& eye, const Vec3d& point, double margin) {
    Crossing result;
    const Vec3d direction = point - eye;
    for (const Triangle& triangle : mesh.triangles) {
        const auto [t, edge] = testing::ray_oracle(mesh, triangle, eye, direction);
        if (edge < -1e-5 || t < margin * 0.9 || t > 1.0 - margin * 0.9) continue;
        if (edge < 1e-5 || t < margin * 1.1 || t > 1.0 - margin * 1.1) {
            result.unclear = true;
        } else {
            result.hidden = true;
        }
    }
    return result;
}

TEST(Hidden, AgreesWithSegmentsAgainstAllTriangles) {
    const double margin = 1.0 / 5000.0;  // as RayScene::hidden() says
    const TriangleMesh mesh = test_meshes::random_triangles(12, 21);
    Random random(22);
    std::size_t hidden = 0;
    std::size_t free = 0;
    for (int i = 0; i < 40; ++i) {
        const Pose T_world_model = test_meshes::random_pose(300U + static_cast<unsigned>(i), 20.0);
        const TriangleMesh moved = transformed(mesh, T_world_model);
        const RayScene scene({moved});
        const RayScene placed(std::vector<PlacedRayModel>{{RayModel(mesh), T_world_model}});
        const auto anywhere = [&] {
            return Vec3d(T_world_model * (1.5 * random.uniform() * random.direction()));
        };
        const Vec3d eye = anywhere();
        std::vector<Vec3d> points;
        for (int k = 0; k < 101; ++k) points.push_back(anywhere());
        // Points on the surface itself: it doesn't hide them from one side.
        for (const Triangle& t : moved.triangles) {
            points.push_back((moved.vertices[t[0]] + moved.vertices[t[1]] + moved.vertices[t[2]])
                                 .cast<double>() /
                             3.0);
        }
        const std::vector<char> result = scene.hidden(eye, points);
        const std::vector<char> of_placed = placed.hidden(eye, points);
        ASSERT_EQ(result.size(), points.size());
        for (std::size_t k = 0; k < points.size(); ++k) {
            const Crossing expected = crossing(moved, eye, points[k], margin);
            if (expected.unclear && !expected.hidden) continue;
            ASSERT_EQ(result[k] != 0, expected.hidden) << i << " " << k;
            ASSERT_EQ(of_placed[k] != 0, expected.hidden) << i << " " << k;
            (expected.hidden ? hidden : free) += 1;
        }
    }
    EXPECT_GT(hidden, 1000U);
    EXPECT_GT(free, 1000U);
}

// A projector beside the sensor looks past a box onto a plane: it draws a shadow that ends where
// the line from the projector over the box's edge meets the plane.
TEST(Shadow, OfABoxOnAPlaneIsWhereGeometrySays) {
    TriangleMesh floor;
    floor.vertices = {Vec3f(-500, -500, 100), Vec3f(500, -500, 100), Vec3f(500, 500, 100),
                      Vec3f(-500, 500, 100)};
    floor.triangles = {{0, 1, 2}, {0, 2, 3}};
    // Top at z = 80, from x = -10 to 10.
    Pose above = Pose::Identity();
    above.translation() = Vec3d(0.0, 0.0, 85.0);
    const RayScene scene({floor, transformed(test_meshes::box({10.0F, 15.0F, 5.0F}), above)});
    for (const double side : {30.0, -30.0}) {
        SensorModel sensor = ideal();
        sensor.projector = Vec3d(side, 0.0, 0.0);
        const RenderedView view = render(scene, kCamera, Pose::Identity(), sensor);
        std::size_t lost = 0;
        for (int v = 0; v < kCamera.height; ++v) {
            for (int u = 0; u < kCamera.width; ++u) {
                const auto p = static_cast<std::size_t>(v * kCamera.width + u);
                if (view.true_mesh[p] != 0) {  // the box is lit
                    ASSERT_EQ(view.mesh[p], 1U);
                    continue;
                }
                // The plane's point is dark if the way to the projector crosses the box.
                const Vec3d point = 100.0 * kCamera.ray(u, v);
                const Vec3d to = sensor.projector - point;
                const auto dark = [&](double grown) {
                    return meets_box(Vec3d(10.0 + grown, 15.0 + grown, 5.0 + grown),
                                     point - above.translation(), to) < 1.0;
                };
                const bool is_lost = !view.cloud.points[p].allFinite();
                lost += is_lost ? 1 : 0;
                ASSERT_EQ(is_lost, view.mesh[p] == kNoIndex);
                // A thousandth of a pixel at the outline may go either way.
                if (dark(-1e-3) == dark(1e-3)) {
                    ASSERT_EQ(is_lost, dark(0.0)) << u << " " << v;
                }
            }
        }
        // On paper: the box's lower edge on the projector's side doesn't matter; its upper edge at
        // the far side, x = -+10 and z = 80, is seen at depth 100 from `side` at
        // side + (-+10 - side) / 80 * 100. The sensor itself sees the floor beyond -+10 / 80 * 100.
        const double end = side + (-std::copysign(10.0, side) - side) * 100.0 / 80.0;
        const double begin = -std::copysign(12.5, side);
        const int row = 62;
        const double scale = kCamera.fx / 100.0;
        int dark_pixels = 0;
        for (int u = 0; u < kCamera.width; ++u) {
            const auto p = static_cast<std::size_t>(row * kCamera.width + u);
            dark_pixels += view.cloud.points[p].allFinite() ? 0 : 1;
        }
        EXPECT_NEAR(dark_pixels, std::abs(end - begin) * scale, 1.0);
        EXPECT_GT(lost, 300U);
        // Without a projector nothing is lost.
        for (const Vec3f& point : render(scene, kCamera, Pose::Identity(), ideal()).cloud.points) {
            ASSERT_TRUE(point.allFinite());
        }
    }
}

}  // namespace
}  // namespace ostraka
