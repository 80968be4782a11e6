// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/drop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/io/mesh_file.hpp"
#include "ostraka/mesh/repair.hpp"
#include "ostraka/simulation/parts.hpp"
#include "simulation/closed_mesh.hpp"
#include "simulation/overlap.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

constexpr double kDiameter = 200.0;  // mm, of all models but the boxes

// 200 mm wide, with holes, hooks, overhangs, flat and round.
const SceneModels& parts() {
    static const SceneModels models = [] {
        std::vector<TriangleMesh> meshes;
        for (const PartKind kind : {PartKind::hook, PartKind::tee, PartKind::gear, PartKind::crank,
                                    PartKind::l_bracket, PartKind::knob, PartKind::stepped_shaft}) {
            TriangleMesh mesh = make_part(kind, {.resolution = 64});
            meshes.push_back(scaled(mesh, kDiameter / measure(mesh).diameter));
        }
        return scene_models(std::move(meshes));
    }();
    return models;
}

const DropModels& drop_parts() {
    static const DropModels models = drop_models(parts());
    return models;
}

SceneModels box_model(const Vec3f& size) {
    TriangleMesh mesh;
    testing::add_box(mesh, -size / 2.0F, size / 2.0F);
    return scene_models({mesh});
}

std::vector<PlacedMesh> place(const SceneModels& models, const DropResult& heap) {
    std::vector<PlacedMesh> placed;
    for (const PlacedModel& object : heap.placed) {
        placed.emplace_back(models.meshes[object.model], object.T_world_model);
    }
    return placed;
}

std::vector<std::uint32_t> repeated(std::uint32_t models, std::size_t count) {
    std::vector<std::uint32_t> chosen(count);
    for (std::size_t i = 0; i < count; ++i) chosen[i] = static_cast<std::uint32_t>(i) % models;
    return chosen;
}

// From an object to the nearest other one, not exact: from its surface points with the nearest
// surface points of others to the others' surface.
double gap(const std::vector<PlacedMesh>& placed, std::size_t object, double spacing) {
    const std::vector<Vec3d> points = placed[object].surface_points(spacing);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t other = 0; other < placed.size(); ++other) {
        const Vec3d apart = (placed[other].low - placed[object].high)
                                .cwiseMax(placed[object].low - placed[other].high);
        if (other == object || apart.maxCoeff() > 5.0) continue;
        std::vector<Vec3f> cloud;
        for (const Vec3d& p : placed[other].surface_points(spacing))
            cloud.push_back(p.cast<float>());
        const KdTree tree(cloud);
        std::vector<std::pair<float, std::size_t>> order;
        for (std::size_t i = 0; i < points.size(); ++i) {
            order.emplace_back(tree.nearest(points[i].cast<float>()).squared_distance, i);
        }
        std::sort(order.begin(), order.end());
        for (std::size_t i = 0; i < std::min<std::size_t>(order.size(), 30); ++i) {
            nearest = std::min(nearest, placed[other].distance(points[order[i].second]));
        }
    }
    return nearest;
}

TEST(Overlap, TheOracleSeesHowDeepOneBoxIsInAnother) {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(0, 0, 0), Vec3f(200, 200, 200));
    Pose T_world_model = Pose::Identity();
    for (const double depth : {-0.5, 0.5, 10.0}) {
        T_world_model.translation() = Vec3d(200.0 - depth, 20.0, 30.0);
        std::vector<PlacedMesh> placed;
        placed.emplace_back(mesh, Pose::Identity());
        placed.emplace_back(mesh, T_world_model);
        EXPECT_NEAR(deepest_overlap(placed, 4.0), std::max(depth, 0.0), 1e-4);
        EXPECT_NEAR(gap(placed, 0, 4.0), depth < 0.0 ? -depth : 0.0, 1.0);
    }
}

TEST(Drop, PartsNeverOverlapAndTouchWhatTheyRestOn) {
    double deepest = 0.0;
    double widest = 0.0;
    int stacked = 0;
    for (std::uint64_t number = 0; number < 12; ++number) {
        const DropSettings settings{.area = number % 2 == 0 ? 0.6 : 1.5,
                                    .settled = 0.5,
                                    .positions = number % 3 == 0 ? 1 : 20,
                                    .seed = 3};
        const DropResult heap = drop(drop_parts(), repeated(7, 8), number, settings);
        ASSERT_EQ(heap.placed.size(), 8U);
        EXPECT_TRUE(heap.left_out.empty());
        const std::vector<PlacedMesh> placed = place(parts(), heap);
        deepest = std::max(deepest, deepest_overlap(placed, 1.5));
        for (std::size_t i = 0; i < placed.size(); ++i) {
            ASSERT_GE(placed[i].low.z(), -1e-9);
            if (placed[i].low.z() < 1e-9) continue;
            ++stacked;
            if (number < 2) widest = std::max(widest, gap(placed, i, 1.0));
        }
    }
    EXPECT_LE(deepest, 1e-3);
    EXPECT_GT(stacked, 20);
    // Contact is within one cell, here 1 mm, sideways; surface points are about 1 mm apart.
    EXPECT_LE(widest, std::sqrt(2.0) + 1.0);
    RecordProperty("deepest_mm", std::to_string(deepest));
    RecordProperty("widest_gap_mm", std::to_string(widest));
}

TEST(Drop, LoweringAnObjectThatLiesOnOthersWouldMakeItOverlap) {
    int lowered = 0;
    int overlapping = 0;
    for (std::uint64_t number = 0; number < 3; ++number) {
        const DropSettings settings{.area = 0.6, .settled = 0.5, .seed = 3};
        const DropResult heap = drop(drop_parts(), repeated(7, 8), number, settings);
        for (std::size_t i = 0; i < heap.placed.size(); ++i) {
            DropResult moved = heap;
            // As contact is found to 1 mm sideways, not where it rests against a steep side.
            moved.placed[i].T_world_model.translation().z() -= 8.0;
            const std::vector<PlacedMesh> placed = place(parts(), moved);
            if (placed[i].low.z() < 0.0) continue;
            ++lowered;
            overlapping += deepest_overlap(placed, 1.0) > 0.1 ? 1 : 0;
        }
    }
    EXPECT_GT(lowered, 10);
    EXPECT_GE(overlapping, lowered * 9 / 10);
}

TEST(Drop, PartsInABinStayWithinItsWallsOrAreLeftOut) {
    const BinSettings bin{.length = 320.0, .width = 260.0, .height = 150.0, .wall = 5.0};
    std::size_t left_out = 0;
    for (std::uint64_t number = 0; number < 6; ++number) {
        const DropResult heap =
            drop(drop_parts(), repeated(7, 14), number, {.bin = bin, .positions = 40});
        EXPECT_EQ(heap.placed.size() + heap.left_out.size(), 14U);
        left_out += heap.left_out.size();
        std::vector<PlacedMesh> placed = place(parts(), heap);
        for (std::size_t i = 0; i < placed.size(); ++i) {
            EXPECT_GE(placed[i].low.x(), -160.0 - 1e-9);
            EXPECT_LE(placed[i].high.x(), 160.0 + 1e-9);
            EXPECT_GE(placed[i].low.y(), -130.0 - 1e-9);
            EXPECT_LE(placed[i].high.y(), 130.0 + 1e-9);
            EXPECT_GE(placed[i].low.z(), -1e-9);
            const PlacedModel& object = heap.placed[i];
            const RollingShape& shape = drop_parts().shapes[object.model];
            EXPECT_LE((object.T_world_model * shape.center_of_mass).z(), bin.height);
        }
        const TriangleMesh walls = bin_mesh(bin);
        placed.emplace_back(walls, Pose::Identity());
        EXPECT_LE(deepest_overlap(placed, 2.0), 1e-3);
    }
    EXPECT_GT(left_out, 0U);
}

TEST(Drop, LeavesOutWhatIsTooLargeForTheBin) {
    const BinSettings bin{.length = 60.0, .width = 60.0, .height = 500.0, .wall = 5.0};
    const DropResult heap = drop(drop_models(box_model(Vec3f(80, 70, 65))), repeated(1, 2), 0,
                                 {.bin = bin, .rotations = 5});
    EXPECT_TRUE(heap.placed.empty());
    EXPECT_EQ(heap.left_out, (std::vector<std::uint32_t>{0, 1}));
}

TEST(Drop, ABoxSettlesOnTheTableAndOthersOnTopAtItsHeight) {
    // A cube in a square bin hardly wider than its diagonal: each falls on those before it.
    const Vec3f size(90.0F, 90.0F, 90.0F);
    const DropModels models = drop_models(box_model(size));
    const BinSettings bin{.length = 128.0, .width = 128.0, .height = 300.0, .wall = 1.0};
    for (std::uint64_t number = 0; number < 10; ++number) {
        const DropResult heap = drop(models, repeated(1, 4), number, {.bin = bin, .settled = 1.0});
        ASSERT_EQ(heap.placed.size(), 3U);  // the fourth's middle would be at 315
        for (std::size_t i = 0; i < 3; ++i) {
            const double height = 45.0 + 90.0 * static_cast<double>(i);
            EXPECT_NEAR(heap.placed[i].T_world_model.translation().z(), height, 1e-4);
        }
        EXPECT_EQ(heap.left_out, (std::vector<std::uint32_t>{3}));
    }
}

// A sphere of rings.
TriangleMesh ball(double radius) {
    TriangleMesh mesh;
    constexpr std::uint32_t kRings = 60;
    constexpr std::uint32_t kSides = 120;
    mesh.vertices = {Vec3f(0, 0, -1), Vec3f(0, 0, 1)};
    for (std::uint32_t ring = 1; ring < kRings; ++ring) {
        const double polar = kPi * ring / kRings;
        for (std::uint32_t side = 0; side < kSides; ++side) {
            const double angle = 2.0 * kPi * side / kSides;
            mesh.vertices.push_back(Vec3d(std::sin(polar) * std::cos(angle),
                                          std::sin(polar) * std::sin(angle), -std::cos(polar))
                                        .cast<float>());
        }
    }
    const auto at = [](std::uint32_t ring, std::uint32_t side) {
        return 2 + (ring - 1) * kSides + side % kSides;
    };
    for (std::uint32_t side = 0; side < kSides; ++side) {
        mesh.triangles.push_back({0, at(1, side + 1), at(1, side)});
        mesh.triangles.push_back({1, at(kRings - 1, side), at(kRings - 1, side + 1)});
        for (std::uint32_t ring = 1; ring + 1 < kRings; ++ring) {
            mesh.triangles.push_back({at(ring, side), at(ring, side + 1), at(ring + 1, side + 1)});
            mesh.triangles.push_back({at(ring, side), at(ring + 1, side + 1), at(ring + 1, side)});
        }
    }
    return scaled(std::move(mesh), radius);
}

TEST(Drop, BallsInACornerTouchFloorAndEachOther) {
    // Two balls of radius 50 in a bin of 120 by 120: the upper slides down until it also meets the
    // walls. In plan their centers are at most 20 sqrt(2) apart, and at that lie lowest.
    const SceneModels models = scene_models({ball(50.0)});
    const DropModels prepared = drop_models(models);
    const BinSettings bin{.length = 120.0, .width = 120.0, .height = 400.0, .wall = 1.0};
    for (std::uint64_t number = 0; number < 10; ++number) {
        const DropResult heap = drop(prepared, repeated(1, 2), number, {.bin = bin});
        ASSERT_EQ(heap.placed.size(), 2U);
        const Vec3d low = heap.placed[0].T_world_model.translation();
        const Vec3d high = heap.placed[1].T_world_model.translation();
        EXPECT_NEAR(low.z(), 50.0, 0.1);
        EXPECT_NEAR(std::abs(high.x()), 10.0, 0.6);
        EXPECT_NEAR(std::abs(high.y()), 10.0, 0.6);
        const double distance = (high - low).norm();
        EXPECT_GE(distance, 100.0 - 0.2);  // the meshes are a little inside their balls
        EXPECT_LE(distance, 100.0 + std::sqrt(2.0) * heap.cell);
    }
}

TEST(Drop, MoreTriesMakeLowerHeaps) {
    const auto mean_height = [](const DropSettings& settings) {
        double sum = 0.0;
        for (std::uint64_t number = 0; number < 10; ++number) {
            for (const PlacedModel& object :
                 drop(drop_parts(), repeated(7, 8), number, settings).placed) {
                const Vec3d& center = drop_parts().shapes[object.model].center_of_mass;
                sum += (object.T_world_model * center).z() / 80.0;
            }
        }
        return sum;
    };
    const double loose = mean_height({.area = 1.2, .positions = 1});
    const double dense = mean_height({.area = 1.2, .positions = 50});
    EXPECT_LT(dense, 0.8 * loose);
    EXPECT_LT(mean_height({.area = 1.2, .positions = 50, .rotations = 4}), dense);
}

TEST(Drop, SettledObjectsLieStillAndOthersAnyHow) {
    for (const double settled : {0.0, 1.0}) {
        int flat = 0;
        const DropModels models = drop_models(box_model(Vec3f(100, 60, 20)));
        for (std::uint64_t number = 0; number < 20; ++number) {
            const DropResult heap = drop(models, repeated(1, 1), number, {.settled = settled});
            const double up = heap.placed[0].T_world_model.linear().row(2).cwiseAbs().maxCoeff();
            flat += up > 1.0 - 1e-9 ? 1 : 0;
        }
        EXPECT_EQ(flat, settled > 0.0 ? 20 : 0);
    }
}

bool same_bits(const DropResult& a, const DropResult& b) {
    if (a.placed.size() != b.placed.size() || a.left_out != b.left_out) return false;
    for (std::size_t i = 0; i < a.placed.size(); ++i) {
        const Mat4d p = a.placed[i].T_world_model.matrix();
        const Mat4d q = b.placed[i].T_world_model.matrix();
        if (a.placed[i].model != b.placed[i].model ||
            std::memcmp(p.data(), q.data(), sizeof(p)) != 0) {
            return false;
        }
    }
    return true;
}

TEST(Drop, DependsOnSeedAndNumberOnly) {
    const DropSettings settings{.rotations = 2, .seed = 9};
    const std::vector<std::uint32_t> chosen = repeated(7, 9);
    std::array<std::array<DropResult, 4>, 2> heaps;
    for (const int threads : {1, 2}) {
        set_thread_count(threads);
        const DropModels models = drop_models(parts());
        parallel_for(4, [&](std::size_t i) {
            heaps[static_cast<std::size_t>(threads) - 1][i] = drop(models, chosen, i, settings);
        });
    }
    set_thread_count(0);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_TRUE(same_bits(heaps[0][i], heaps[1][i]));
        EXPECT_FALSE(same_bits(heaps[0][i], heaps[0][(i + 1) % 4]));
    }
    DropSettings other = settings;
    other.seed = 10;
    EXPECT_FALSE(same_bits(heaps[0][0], drop(drop_parts(), chosen, 0, other)));
}

TEST(Drop, RefusesSettingsOutOfRange) {
    const std::vector<std::uint32_t> chosen = {0};
    const auto refuses = [&](const DropSettings& settings) {
        EXPECT_THROW(drop(drop_parts(), chosen, 0, settings), InvalidInput);
    };
    refuses({.bin = BinSettings{}});
    refuses({.bin = BinSettings{100.0, 100.0, std::nan(""), 1.0}});
    refuses({.bin = BinSettings{1e9, 1e9, 1.0, 1.0}});
    refuses({.area = -1.0});
    refuses({.area = 1e5});
    refuses({.settled = 1.5});
    refuses({.positions = 0});
    refuses({.rotations = 0});
    refuses({.cells = 5});
    EXPECT_THROW(drop(drop_parts(), {}, 0), InvalidInput);
    EXPECT_THROW(drop(drop_parts(), std::vector<std::uint32_t>{7}, 0), InvalidInput);
    // A table without area is one place.
    EXPECT_EQ(drop(drop_parts(), chosen, 0, {.area = 0.0}).placed.size(), 1U);
}

TEST(BinMesh, IsAClosedTrayOfItsMeasures) {
    const TriangleMesh mesh =
        bin_mesh({.length = 300.0, .width = 200.0, .height = 100.0, .wall = 10.0});
    const ClosedMeshReport report = examine(mesh);
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(report.manifold);
    EXPECT_EQ(report.components, 1);
    EXPECT_NEAR(report.volume, 320.0 * 220.0 * 110.0 - 300.0 * 200.0 * 100.0, 1.0);
}

TEST(Drop, BolognaModelsDoNotOverlap) {
    const char* data = std::getenv("OSTRAKA_DATA");
    const std::filesystem::path folder =
        std::filesystem::path(data == nullptr ? "" : data) / "bologna" / "models";
    if (data == nullptr || !std::filesystem::exists(folder)) {
        GTEST_SKIP() << "needs the Bologna models: set OSTRAKA_DATA to the folder that holds "
                        "bologna/models";
    }
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        paths.push_back(entry.path());
    }
    std::sort(paths.begin(), paths.end());
    std::vector<TriangleMesh> meshes;
    for (const std::filesystem::path& path : paths) {
        const TriangleMesh mesh = repair(read_mesh(path)).mesh;
        meshes.push_back(scaled(mesh, kDiameter / measure(mesh).diameter));
    }
    const SceneModels models = scene_models(std::move(meshes));
    const DropModels prepared = drop_models(models);
    double deepest = 0.0;
    for (std::uint64_t number = 0; number < 3; ++number) {
        const DropSettings settings{.area = number == 0 ? 2.0 : 0.7,
                                    .positions = number == 1 ? 1 : 30};
        const DropResult heap = drop(prepared, repeated(6, 8), number, settings);
        deepest = std::max(deepest, deepest_overlap(place(models, heap), 4.0));
        if (number != 1) continue;
        // The oracle sees it in these meshes too if there is an overlap.
        DropResult lowered = heap;
        lowered.placed.back().T_world_model.translation().z() -= 10.0;
        EXPECT_GT(deepest_overlap(place(models, lowered), 4.0), 0.5);
    }
    EXPECT_LE(deepest, 1e-3);
    RecordProperty("deepest_mm", std::to_string(deepest));
}

}  // namespace
}  // namespace ostraka
