// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/recipes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <set>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

const PinholeCamera kSmall{160, 120, 140.0, 140.0, 79.5, 59.5};

SceneModels two_models() {
    return scene_models({testing::corner_model(), testing::plate_model()});
}

std::vector<SceneRecipe> all_recipes() {
    SensorModel sensor;
    sensor.ranging.noise = 0.3;
    RandomViewSettings random_views;
    random_views.camera = kSmall;
    random_views.sensor = sensor;
    const TabletopScenes tabletop{{.objects = 3, .camera = kSmall, .sensor = sensor}};
    DropScenes heap{.objects = 4, .camera = kSmall, .sensor = sensor};
    heap.drop.cells = 60;
    DropScenes bin = heap;
    bin.drop.bin = BinSettings{300.0, 200.0, 100.0, 5.0};
    Pose ahead = Pose::Identity();
    ahead.translation() = Vec3d(-30.0, -20.0, 300.0);
    LayoutScenes layout{.placed = {{{0, ahead}}, {{1, ahead}}, {{0, ahead}, {1, ahead}}}};
    layout.camera = kSmall;
    layout.sensor = sensor;
    return {random_views, tabletop, heap, bin, layout};
}

TEST(ChooseModels, TakesTurnsEvenly) {
    // 7 models, 5 a scene: after any number of scenes no model leads another by more than a turn.
    std::vector<int> counts(7, 0);
    std::set<std::vector<std::uint32_t>> orders;
    for (std::uint64_t number = 0; number < 50; ++number) {
        const auto chosen = choose_models(7, 5, number, ModelChoice::in_turns, 3);
        ASSERT_EQ(chosen.size(), 5U);
        for (const std::uint32_t model : chosen) ++counts.at(model);
        const auto [least, most] = std::minmax_element(counts.begin(), counts.end());
        ASSERT_LE(*most - *least, 1) << number;
        orders.insert(chosen);
    }
    EXPECT_GT(orders.size(), 20U);  // who comes when is shuffled
    EXPECT_NE(choose_models(7, 7, 0, ModelChoice::in_turns, 3),
              choose_models(7, 7, 0, ModelChoice::in_turns, 4));
}

TEST(ChooseModels, DrawsAllModelsAboutAsOften) {
    std::vector<int> counts(4, 0);
    bool twice = false;
    for (std::uint64_t number = 0; number < 1000; ++number) {
        const auto chosen = choose_models(4, 2, number, ModelChoice::random, 0);
        twice = twice || chosen[0] == chosen[1];
        for (const std::uint32_t model : chosen) ++counts.at(model);
    }
    // 500 each, with a deviation of 19.
    for (const int count : counts) EXPECT_NEAR(count, 500, 100);
    EXPECT_TRUE(twice);
    EXPECT_TRUE(choose_models(4, 0, 0, ModelChoice::random, 0).empty());
}

TEST(SceneSimulator, MakesTheSameForAnyNumberOfThreads) {
    for (const SceneRecipe& recipe : all_recipes()) {
        std::vector<SimulatedScene> made;
        for (const int threads : {1, 2}) {
            set_thread_count(threads);
            made.push_back(SceneSimulator(two_models(), recipe).make(2));
        }
        set_thread_count(0);
        ASSERT_FALSE(made[0].objects.empty()) << recipe.index();
        ASSERT_EQ(made[0].cloud.size(), made[1].cloud.size());
        EXPECT_EQ(std::memcmp(made[0].cloud.points.data(), made[1].cloud.points.data(),
                              made[0].cloud.size() * sizeof(Vec3f)),
                  0)
            << recipe.index();
        EXPECT_EQ(made[0].labels, made[1].labels);
        EXPECT_EQ(made[0].silhouettes, made[1].silhouettes);
        ASSERT_EQ(made[0].objects.size(), made[1].objects.size());
        for (std::size_t o = 0; o < made[0].objects.size(); ++o) {
            EXPECT_EQ(made[0].objects[o].T_scene_model.matrix(),
                      made[1].objects[o].T_scene_model.matrix());
            EXPECT_EQ(made[0].objects[o].visible_fraction, made[1].objects[o].visible_fraction);
        }
    }
}

TEST(SceneSimulator, ScenesDifferAndOnlyLayoutsEnd) {
    for (const SceneRecipe& recipe : all_recipes()) {
        const SceneSimulator simulator(two_models(), recipe);
        EXPECT_NE(simulator.make(0).labels, simulator.make(1).labels) << recipe.index();
        const bool layout = std::holds_alternative<LayoutScenes>(recipe);
        EXPECT_EQ(simulator.limit(), layout ? 3U : std::numeric_limits<std::size_t>::max());
    }
}

TEST(SceneSimulator, RefusesWhatItCannotMake) {
    EXPECT_THROW(SceneSimulator({}, RandomViewSettings{}), InvalidInput);
    EXPECT_THROW(SceneSimulator(two_models(), LayoutScenes{.placed = {{{2, Pose::Identity()}}}}),
                 InvalidInput);
}

Pose at(double x, double y, double z) {
    Pose pose = Pose::Identity();
    pose.translation() = Vec3d(x, y, z);
    return pose;
}

TriangleMesh plate(float half) {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(-half, -half, 0.0F), Vec3f(half, half, 0.001F));
    return mesh;
}

// A plate 20 x 20 pixels large, its left part behind another: in whole columns, so exactly.
TEST(VisibleFraction, OfAPartlyHiddenPlateIsItsShareOfColumns) {
    const PinholeCamera camera{100, 80, 100.0, 100.0, 49.5, 39.5};
    for (const int hidden : {0, 5, 10, 19, 20}) {
        LayoutScenes layout;
        layout.camera = camera;
        // Half 10 at depth 100 ends 10 pixels beside the middle; the near one, half 30 at depth 50,
        // is 60 pixels to either side of where it stands.
        layout.placed = {{{0, at(0, 0, 100)}, {1, at((hidden - 70) / 2.0, 0, 50)}}};
        const SimulatedScene scene =
            SceneSimulator(scene_models({plate(10.0F), plate(30.0F)}), layout).make(0);
        EXPECT_EQ(scene.objects[0].pixels_total, 400U);
        EXPECT_EQ(scene.objects[0].pixels_visible, 20U * static_cast<unsigned>(20 - hidden));
        EXPECT_DOUBLE_EQ(scene.objects[0].visible_fraction, (20 - hidden) / 20.0) << hidden;
    }
}

TEST(VisibleFraction, SilhouettesBeyondTheBorderCount) {
    const PinholeCamera camera{100, 80, 100.0, 100.0, 49.5, 39.5};
    LayoutScenes layout;
    layout.camera = camera;
    // 50 to the right at depth 100: columns 90 to 109, of which 90 to 99 are in the image.
    layout.placed = {{{0, at(50.0, 0.0, 100.0)}}, {{0, at(70.0, 0.0, 100.0)}}};
    const SceneSimulator simulator(scene_models({plate(10.0F)}), layout);
    const SimulatedScene half = simulator.make(0);
    EXPECT_EQ(half.objects[0].pixels_total, 400U);
    EXPECT_DOUBLE_EQ(half.objects[0].visible_fraction, 0.5);
    EXPECT_EQ(half.silhouettes[0].size(), 200U);  // pixels have indices in the image only
    for (const std::uint32_t pixel : half.silhouettes[0]) ASSERT_GE(pixel % 100, 90U);
    const SimulatedScene outside = simulator.make(1);
    EXPECT_EQ(outside.objects[0].pixels_total, 400U);
    EXPECT_EQ(outside.objects[0].visible_fraction, 0.0);
    EXPECT_TRUE(outside.silhouettes[0].empty());
}

}  // namespace
}  // namespace ostraka
