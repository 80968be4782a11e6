// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/near_symmetry.hpp"

#include <cmath>

#include "ostraka/mesh/symmetry_poses.hpp"
#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

// A square plate; with a mark it is nearly symmetric only.
TriangleMesh square_plate(bool marked) {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(-40, -40, 0), Vec3f(40, 40, 24));
    if (marked) testing::add_box(mesh, Vec3f(22, 18, 24), Vec3f(34, 26, 34));
    return mesh;
}

void add_disk(TriangleMesh& mesh, float radius, float height) {
    constexpr std::uint32_t kSides = 64;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t i = 0; i < kSides; ++i) {
        const double angle = 2.0 * kPi * i / kSides;
        const auto x = static_cast<float>(radius * std::cos(angle));
        const auto y = static_cast<float>(radius * std::sin(angle));
        mesh.vertices.emplace_back(x, y, 0.0F);
        mesh.vertices.emplace_back(x, y, height);
    }
    for (std::uint32_t i = 0; i < kSides; ++i) {
        const std::uint32_t a = first + 2 * i;
        const std::uint32_t b = first + 2 * ((i + 1) % kSides);
        mesh.triangles.push_back({a, b, b + 1});
        mesh.triangles.push_back({a, b + 1, a + 1});
        if (i == 0 || i + 1 == kSides) continue;
        mesh.triangles.push_back({first, b, a});
        mesh.triangles.push_back({first + 1, a + 1, b + 1});
    }
}

// A disk with a mark at its edge.
TriangleMesh marked_disk() {
    TriangleMesh mesh;
    add_disk(mesh, 45.0F, 20.0F);
    testing::add_box(mesh, Vec3f(30, -3, 20), Vec3f(42, 3, 26));
    return mesh;
}

// A cup of which nobody sees the inside: about as wide as high, so that little tilts its axes.
TriangleMesh cup() {
    TriangleMesh mesh;
    add_disk(mesh, 40.0F, 74.0F);
    testing::add_box(mesh, Vec3f(38, -6, 50), Vec3f(66, 6, 70));
    return mesh;
}

ModelLibrary library_of(TriangleMesh mesh) {
    const std::vector<ModelSource> models = {{.name = "plate", .mesh = std::move(mesh)}};
    return build_library(models, testing::quick_settings());
}

std::vector<Pose> turns_of(const ModelLibrary& library) {
    return ModelProbe(library.models[0], library.settings.sampling).turns();
}

// Degrees of the turn.
double angle_of(const Pose& turn) {
    return Eigen::AngleAxisd(Mat3d(turn.linear())).angle() * 180.0 / kPi;
}

TEST(NearSymmetries, AreThreeQuarterTurnsAndTheHalfTurnsAcrossOfAMarkedSquarePlate) {
    const auto turns = turns_of(library_of(square_plate(true)));
    ASSERT_EQ(turns.size(), 7U);
    for (const Pose& turn : turns) {
        const double off = std::remainder(angle_of(turn), 90.0);
        EXPECT_LT(std::abs(off), 1.5) << angle_of(turn);
        // The plate without its mark lies on itself again, with its center at (0 0 12).
        EXPECT_LT((turn * Vec3d(0, 0, 12) - Vec3d(0, 0, 12)).norm(), 0.5);
        EXPECT_GT((turn.linear() * Vec3d::UnitZ()).cwiseAbs().z(), 0.999);
    }
}

TEST(NearSymmetries, AreNoneWhereAllAreExact) {
    EXPECT_EQ(turns_of(library_of(square_plate(false))).size(), 0U);
}

TEST(NearSymmetries, AreNoneOfModelsThatAreFarFromIt) {
    EXPECT_TRUE(probe(kCorner).turns().empty());
    EXPECT_TRUE(probe(kPlate).turns().empty());
}

TEST(NearSymmetries, GoAllAroundAMarkedDiskAndTurnItOver) {
    const auto turns = turns_of(library_of(marked_disk()));
    std::size_t over = 0;
    for (const Pose& turn : turns) {
        const double up = (turn.linear() * Vec3d::UnitZ()).z();
        EXPECT_GT(std::abs(up), 0.999);
        over += up < 0.0 ? 1U : 0U;
    }
    EXPECT_GE(turns.size() - over, 30U);
    EXPECT_GE(over, 30U);
}

TEST(NearSymmetries, GoAllAroundACupWhoseHandleTiltsItsAxes) {
    const ModelLibrary library = library_of(cup());
    const Mat3d& axes = library.models[0].shape.axes;
    ASSERT_LT(axes.row(2).cwiseAbs().maxCoeff(), 0.98);
    std::size_t upright = 0;  // about the cup's own axis
    for (const Pose& turn : turns_of(library)) {
        const bool same_axis = (turn.linear() * Vec3d::UnitZ()).z() > 0.999;
        if (same_axis && (turn * Vec3d::Zero()).norm() < 1.0) ++upright;
    }
    EXPECT_GE(upright, 30U);
}

// With and without noise, from above, where the mark is seen.
TEST(NearSymmetries, TheMarkTellsWhichTurnIsReported) {
    const ModelLibrary library = library_of(marked_disk());
    const SceneModels disks = scene_models({marked_disk()});
    const Recognizer recognizer(library);
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        PlacedModel placed{0, Pose::Identity()};
        const double angle = 0.3 + 0.7 * static_cast<double>(seed);
        placed.T_world_model.linear() = Eigen::AngleAxisd(angle, Vec3d::UnitZ()).toRotationMatrix();
        SceneView view{.T_camera_world = look_at(Vec3d(0, -180, 360), Vec3d::Zero())};
        view.sensor.ranging.noise = seed % 2 == 0 ? 0.0 : 0.4;
        view.sensor.ranging.seed = seed;
        const SimulatedScene scene = simulate_scene(disks, {&placed, 1}, view);
        const auto objects = recognizer.recognize(scene.cloud, {.min_confidence = 0.3}).objects;
        ASSERT_EQ(objects.size(), 1U) << seed;
        const PoseDifference off =
            symmetric_difference({}, objects[0].T_scene_model, scene.objects[0].T_scene_model);
        EXPECT_LT(off.angle, 0.05) << seed;
    }
}

}  // namespace
}  // namespace ostraka
