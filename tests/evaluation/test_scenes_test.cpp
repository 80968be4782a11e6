// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/test_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/evaluation_testing.hpp"
#include "io/io_testing.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/io/bop_writer.hpp"
#include "ostraka/io/cloud_file.hpp"

namespace ostraka {
namespace {

using namespace evaluation_testing;
using namespace io_testing;

constexpr double kBopStep = 0.1;  // mm, of the depth images

TriangleMesh ball_free_block() {
    TriangleMesh mesh;
    testing::add_box(mesh, Vec3f(0, 0, 0), Vec3f(50, 40, 30));
    testing::add_box(mesh, Vec3f(0, 0, 30), Vec3f(10, 10, 60));
    return mesh;
}

// Objects on a table, all of them: 0 corner and 1 plate, as in small_library(), 2 a stranger to it.
SimulatedScene scan_of_three(std::uint64_t number) {
    const SceneModels models =
        scene_models({testing::corner_model(), testing::plate_model(), ball_free_block()});
    TabletopSettings settings;
    settings.spacing = 1.5;
    settings.camera = small_camera(320);
    settings.camera.height = 200;  // no camera has the aspect or the center that others assume
    settings.camera.cy = 91.25;
    const std::vector<std::uint32_t> chosen = {2, 0, 1};
    return simulate_tabletop(models, chosen, number, settings);
}

// The scan as a BOP set in mm; the models' numbers are another order than the library's.
void write_bop_set(const std::filesystem::path& root) {
    const std::vector<BopModel> models = {{"stranger", ball_free_block(), {}},
                                          {"plate", testing::plate_model(), {}},
                                          {"corner", testing::corner_model(), {}}};
    const std::vector<int> numbers = {3, 2, 1};  // of SimulatedScene's models
    BopWriter writer(root, models, Unit::millimeter, {.depth_scale = kBopStep});
    for (std::uint64_t i = 0; i < 2; ++i) {
        const SimulatedScene scene = scan_of_three(i);
        BopImage image{.camera = scene.camera};
        for (const Vec3f& point : scene.cloud.points) image.depth.push_back(point.z());
        for (const TrueObject& object : scene.objects) {
            image.objects.push_back({.number = numbers[object.model],
                                     .T_camera_model = object.T_scene_model,
                                     .visible_fraction = i == 0 ? object.visible_fraction : -1.0});
        }
        writer.write(i, image);
    }
    writer.finish();
}

TEST(SimulatedSet, HoldsTheSimulatorsScenes) {
    RandomViewSettings recipe;
    recipe.camera = small_camera();
    const TestSet set = simulated_set(small_library(), recipe, 3);
    EXPECT_EQ(set.count, 3U);
    EXPECT_TRUE(set.notes.empty());
    const SceneSimulator simulator(scene_models_of(small_library()), recipe);
    for (std::size_t i = 0; i < 3; ++i) {
        const TestScene scene = set.load(i);
        const SimulatedScene made = simulator.make(i);
        EXPECT_EQ(scene.name, fmt::format("scene_{:04}", i));
        EXPECT_EQ(scene.image, static_cast<int>(i));
        expect_same(scene.cloud, made.cloud);
        EXPECT_EQ(scene.labels, made.labels);
        ASSERT_EQ(scene.objects.size(), made.objects.size());
        for (std::size_t o = 0; o < scene.objects.size(); ++o) {
            EXPECT_EQ(scene.objects[o].model, made.objects[o].model);
            EXPECT_EQ(scene.objects[o].visible_fraction, made.objects[o].visible_fraction);
        }
        ASSERT_TRUE(scene.camera.has_value());
        EXPECT_EQ(scene.camera->width * scene.camera->height, 128 * 96);
    }
}

TEST(SimulatedSet, ALayoutHasAsManyScenesAsItHas) {
    LayoutScenes layout;
    layout.camera = small_camera();
    layout.placed = {{{0, shifted(0, 0, 400)}},
                     {{1, shifted(0, 0, 500)}, {0, shifted(99, 0, 500)}}};
    const TestSet set = simulated_set(small_library(), layout, 100);
    EXPECT_EQ(set.count, 2U);
    EXPECT_EQ(set.load(1).objects.size(), 2U);
    EXPECT_EQ(simulated_set(small_library(), layout, 1).count, 1U);
    layout.placed[0][0].model = 2;
    EXPECT_THROW(simulated_set(small_library(), layout, 1), InvalidInput);
}

TEST(RecordedSet, ReadsBopsFilesInTheLibrarysUnit) {
    const TestFolder folder;
    write_bop_set(folder / "set");
    // The library's meters are taken for what they are: its sizes are 80 m, the set's 80 mm.
    for (const double factor : {1.0, 0.001}) {
        ModelLibrary library = small_library();
        if (factor != 1.0) {
            library.settings.unit = Unit::meter;
            library.settings.sampling *= factor;
            for (Model& model : library.models) {
                model.surface = scaled(model.surface, factor);
                model.shape.center *= factor;
                model.shape.radius *= factor;
                model.shape.diameter *= factor;
            }
        }
        const TestSet set = recorded_set(open_data_set(folder / "set"), library, std::nullopt);
        ASSERT_EQ(set.count, 2U);
        ASSERT_EQ(set.notes.size(), 1U);
        EXPECT_EQ(set.notes[0], "not in the library, left out: stranger");
        const TestScene scene = set.load(0);
        const SimulatedScene made = scan_of_three(0);
        EXPECT_EQ(scene.name, "000001/000000");
        EXPECT_EQ(scene.scene, 1);
        EXPECT_EQ(scene.image, 0);
        EXPECT_EQ(set.load(1).image, 1);
        ASSERT_TRUE(scene.camera.has_value());
        EXPECT_EQ(scene.camera->width, 320);
        EXPECT_EQ(scene.camera->height, 200);
        EXPECT_EQ(scene.camera->cy, 91.25);
        // The stranger was first in the image.
        ASSERT_EQ(scene.objects.size(), 2U);
        for (std::size_t o = 0; o < 2; ++o) {
            const TrueObject& truth = made.objects[o + 1];
            EXPECT_EQ(scene.objects[o].model, truth.model);
            EXPECT_EQ(scene.objects[o].visible_fraction, truth.visible_fraction);
            EXPECT_EQ(set.load(1).objects[o].visible_fraction, 1.0);  // not stated
            Pose expected = truth.T_scene_model;
            expected.translation() *= factor;
            EXPECT_LT((scene.objects[o].T_scene_model.matrix() - expected.matrix()).norm(),
                      1e-9 * expected.translation().norm());
        }
        ASSERT_EQ(scene.cloud.size(), made.cloud.size());
        for (std::size_t i = 0; i < scene.cloud.size(); ++i) {
            const float depth = made.cloud.points[i].z();
            ASSERT_EQ(std::isnan(scene.cloud.points[i].z()), std::isnan(depth));
            if (std::isnan(depth)) continue;
            ASSERT_NEAR(scene.cloud.points[i].z(), factor * depth, 0.51 * kBopStep * factor);
        }
    }
}

TEST(RecordedSet, LabelsPointsByTheNearestSurface) {
    const TestFolder folder;
    write_bop_set(folder / "set");
    const TestSet set = recorded_set(open_data_set(folder / "set"), small_library(), std::nullopt);
    for (std::size_t number = 0; number < 2; ++number) {
        const TestScene scene = set.load(number);
        const SimulatedScene made = scan_of_three(number);
        ASSERT_EQ(scene.labels.size(), made.labels.size());
        std::size_t objects = 0;
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < scene.labels.size(); ++i) {
            // Object 0 of the simulated scene is the stranger, which is nobody's here.
            const std::uint32_t truth = made.labels[i];
            const std::uint32_t expected = truth == kNoIndex || truth == 0 ? kNoIndex : truth - 1;
            if (expected != kNoIndex) ++objects;
            if (expected != scene.labels[i]) ++wrong;
            if (std::isnan(scene.cloud.points[i].z())) {
                ASSERT_EQ(scene.labels[i], kNoIndex);
            }
        }
        EXPECT_GT(objects, 1000U);
        // Where an object stands on the table, the table is within a sampling distance, too.
        EXPECT_LT(wrong, objects / 20);
    }
}

std::string numbers_of(const Pose& pose) {
    std::string text;
    for (int i = 0; i < 16; ++i) {
        text += fmt::format("{}{:.17g}", i == 0 ? "" : ",", pose.matrix()(i / 4, i % 4));
    }
    return text;
}

TEST(RecordedSet, ReadsOurOwnFilesAndAsksForAUnitThatIsMissing) {
    const TestFolder folder;
    const SimulatedScene made = scan_of_three(3);
    write_cloud(folder / "scene_0000.pcd", made.cloud);
    const std::string object = R"({"model": "NAME", "T_scene_model": [POSE]})";
    std::string list;
    for (const TrueObject& truth : made.objects) {
        const std::string name = truth.model == 0 ? "corner" : truth.model == 1 ? "plate" : "x";
        list += (list.empty() ? "" : ",") +
                replaced(replaced(object, "NAME", name), "POSE", numbers_of(truth.T_scene_model));
    }
    const std::string text = R"({"scene": "scene_0000.pcd", UNIT"objects": [)" + list + "]}";
    save(folder / "scene_0000.json", replaced(text, "UNIT", R"("unit": "mm", )"));
    const TestSet set = recorded_set(open_data_set(folder.path()), small_library(), std::nullopt);
    EXPECT_EQ(set.count, 1U);
    EXPECT_EQ(set.notes, std::vector<std::string>{"not in the library, left out: x"});
    const TestScene scene = set.load(0);
    EXPECT_EQ(scene.name, "scene_0000");
    EXPECT_FALSE(scene.camera.has_value());  // a cloud doesn't say what camera saw it
    ASSERT_EQ(scene.objects.size(), 2U);
    EXPECT_EQ(scene.objects[0].visible_fraction, 1.0);
    // The reader makes rotations exactly orthonormal.
    const Eigen::Matrix4d off =
        scene.objects[0].T_scene_model.matrix() - made.objects[1].T_scene_model.matrix();
    EXPECT_LT(off.norm(), 1e-12);
    expect_same(scene.cloud.points, made.cloud.points);

    // A set that doesn't state its unit is not guessed at.
    DataSet unitless = open_data_set(folder.path());
    unitless.unit.reset();
    EXPECT_THROW(recorded_set(unitless, small_library(), std::nullopt), InvalidInput);
    const TestSet tenfold = recorded_set(unitless, small_library(), Unit::centimeter);
    EXPECT_NEAR(tenfold.load(0).objects[0].T_scene_model.translation().z(),
                10.0 * made.objects[1].T_scene_model.translation().z(), 1e-9);

    // Nothing of it is in a library of other names.
    ModelLibrary strangers = small_library();
    for (Model& model : strangers.models) model.name = "another " + model.name;
    EXPECT_THROW(recorded_set(open_data_set(folder.path()), strangers, std::nullopt), InvalidInput);
}

TEST(LayoutOf, GivesTheSetsPosesInAnotherUnit) {
    const TestFolder folder;
    write_bop_set(folder / "set");
    const DataSet data = open_data_set(folder / "set");
    const std::vector<std::string> names = {"plate", "nobody", "corner"};
    std::vector<std::string> notes;
    const auto scenes = layout_of(data, names, 0.001, &notes);
    EXPECT_EQ(notes, std::vector<std::string>{"not in the library, left out: stranger"});
    ASSERT_EQ(scenes.size(), 2U);
    ASSERT_EQ(scenes[0].size(), 2U);
    EXPECT_EQ(scenes[0][0].model, 2U);
    EXPECT_EQ(scenes[0][1].model, 0U);
    const SimulatedScene made = scan_of_three(0);
    EXPECT_LT((scenes[0][0].T_world_model.translation() * 1000.0 -
               made.objects[1].T_scene_model.translation())
                  .norm(),
              1e-9);
    EXPECT_LT((scenes[0][0].T_world_model.linear() - made.objects[1].T_scene_model.linear()).norm(),
              1e-12);
    // Poses are in a camera's frame, so that is where a layout's camera stands.
    EXPECT_EQ(layout_camera(data).matrix(), Pose::Identity().matrix());
    EXPECT_THROW(layout_of(data, std::vector<std::string>{"nobody"}, 1.0, nullptr), InvalidInput);
}

TEST(LayoutCamera, OfUwasScansLooksAlongMinusZ) {
    DataSet data;
    data.kind = DataSetKind::uwa;
    const Vec3d seen = layout_camera(data) * Vec3d(1.0, 2.0, -700.0);
    EXPECT_LT((seen - Vec3d(1.0, -2.0, 700.0)).norm(), 1e-9);
}

}  // namespace
}  // namespace ostraka
