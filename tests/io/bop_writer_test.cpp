// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/bop_writer.hpp"

#include "io/io_testing.hpp"
#include "mesh/test_meshes.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/io/data_set.hpp"
#include "ostraka/io/mesh_file.hpp"
#include "ostraka/io/models_info.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

constexpr int kWidth = 8;
constexpr int kHeight = 6;

std::vector<BopModel> make_models() {
    std::vector<BopModel> models(2);
    models[0] = {"box", test_meshes::box({0.01F, 0.02F, 0.03F}), {}};
    models[0].symmetry.axes = {{Vec3d::UnitZ(), Vec3d(0.001, 0.0, 0.0)}};
    models[1] = {"ball", test_meshes::sphere(0.05, 8), {}};
    return models;
}

// Depends on its number in everything.
BopImage make_image(int number) {
    BopImage image;
    image.camera = {kWidth, kHeight, 500.0 / 3.0 + number, 501.5, 3.4, 2.6};
    for (int i = 0; i < kWidth * kHeight; ++i) {
        image.depth.push_back(i % 7 == 0 ? 0.0F : 500.0F + static_cast<float>(i) / 3.0F);
    }
    image.depth[1] = std::numeric_limits<float>::quiet_NaN();
    image.objects.resize(2);
    image.masks.resize(2);
    for (int k = 0; k < 2; ++k) {
        BopObject& object = image.objects[static_cast<std::size_t>(k)];
        object.number = 1 + (number + k) % 2;
        object.T_camera_model =
            test_meshes::random_pose(static_cast<std::uint64_t>(10 * number + k), 300.0);
        BopMasks& masks = image.masks[static_cast<std::size_t>(k)];
        masks.all.assign(kWidth * kHeight, 0);
        masks.visible = masks.all;
        for (std::size_t i = 10; i < 14; ++i) masks.all[i] = 1;
        for (std::size_t i = 18; i < 22; ++i) masks.all[i] = 1;
        // Image 1 hides its second object; elsewhere 2 of 8 pixels are seen.
        if (number != 1 || k == 0) masks.visible[11] = masks.visible[12] = 1;
    }
    measure_masks(image);
    return image;
}

void write_set(const std::filesystem::path& root, int images, const BopWriterSettings& settings) {
    const std::vector<BopModel> models = make_models();
    BopWriter writer(root, models, Unit::meter, settings);
    for (int i = images - 1; i >= 0; --i) writer.write(static_cast<std::size_t>(i), make_image(i));
    writer.finish();
}

TEST(BopWriter, WritesWhatDataSetReaderReads) {
    const TestFolder folder;
    write_set(folder / "set", 5, {.images_per_scene = 2});
    const DataSet set = open_data_set(folder / "set");
    EXPECT_EQ(set.kind, DataSetKind::bop);
    EXPECT_EQ(set.unit, Unit::millimeter);
    ASSERT_EQ(set.models.size(), 2U);
    EXPECT_EQ(set.models[0].name, "box");
    EXPECT_EQ(set.models[1].number, 2);
    ASSERT_EQ(set.scenes.size(), 5U);
    EXPECT_EQ(set.scenes[4].name, "000003/000000");
    for (int i = 0; i < 5; ++i) {
        const RecordedScene& scene = set.scenes[static_cast<std::size_t>(i)];
        const BopImage image = make_image(i);
        EXPECT_EQ(scene.scene, i / 2 + 1);
        EXPECT_EQ(scene.image, i % 2);
        ASSERT_TRUE(scene.depth.has_value());
        EXPECT_EQ(scene.depth->camera.fx, image.camera.fx);
        EXPECT_EQ(scene.depth->camera.width, kWidth);
        EXPECT_EQ(scene.depth->depth_scale, 0.1);
        EXPECT_EQ(scene.viewpoint, Vec3f::Zero());
        ASSERT_EQ(scene.objects.size(), 2U);
        for (std::size_t k = 0; k < 2; ++k) {
            const Pose& written = image.objects[k].T_camera_model;
            const Pose& read = scene.objects[k].T_scene_model;
            EXPECT_EQ(set.models[scene.objects[k].model].number, image.objects[k].number);
            EXPECT_LT((read.matrix() - written.matrix()).cwiseAbs().maxCoeff(), 1e-12);
            EXPECT_EQ(scene.objects[k].visible_fraction, image.objects[k].visible_fraction);
        }
        const PointCloud cloud = read_scan(scene);
        ASSERT_EQ(cloud.size(), image.depth.size());
        EXPECT_EQ(cloud.width, kWidth);
        for (std::size_t p = 0; p < cloud.size(); ++p) {
            if (!(image.depth[p] > 0.0F)) {
                EXPECT_TRUE(std::isnan(cloud.points[p].z()));
                continue;
            }
            EXPECT_NEAR(cloud.points[p].z(), image.depth[p], 0.0501);
            const Vec2d pixel = image.camera.project(cloud.points[p].cast<double>());
            EXPECT_NEAR(pixel.x(), static_cast<double>(p % kWidth), 1e-3);
            EXPECT_NEAR(pixel.y(), static_cast<double>(p / kWidth), 1e-3);
        }
    }
}

TEST(BopWriter, WritesTheFilesOfTheFormat) {
    const TestFolder folder;
    write_set(folder / "set", 3, {.images_per_scene = 2});
    const std::filesystem::path root = folder / "set";
    for (const char* models : {"models", "models_eval"}) {
        const TriangleMesh mesh = read_mesh(root / models / "obj_000001.ply");
        EXPECT_NEAR(mesh.vertices[0].cwiseAbs().maxCoeff(), 30.0F, 1e-4F);  // mm
        const std::vector<ModelInfo> info = read_models_info(root / models / "models_info.json");
        ASSERT_EQ(info.size(), 2U);
        EXPECT_NEAR(info[0].size.z(), 60.0, 1e-4);
        ASSERT_EQ(info[0].symmetry.axes.size(), 1U);
        EXPECT_NEAR(info[0].symmetry.axes[0].point.x(), 1.0, 1e-12);
    }
    const DepthCamera camera = read_camera_json(root / "camera.json");
    EXPECT_EQ(camera.camera.fx, make_image(0).camera.fx);
    EXPECT_EQ(camera.camera.width, kWidth);
    EXPECT_EQ(camera.depth_scale, 0.1);
    EXPECT_FALSE(camera.unit.has_value());
    for (const char* file : {"000001/mask/000001_000001.png", "000001/mask_visib/000001_000001.png",
                             "000002/mask/000000_000000.png", "000002/depth/000000.png"}) {
        EXPECT_EQ(read_png_size(root / "test" / file).width, kWidth) << file;
    }
    // Object 1 of image 1 is hidden, so no target; the others have a target each.
    const std::vector<BopTarget> targets = read_bop_targets(root / "test_targets_bop19.json");
    ASSERT_EQ(targets.size(), 5U);
    EXPECT_EQ(targets[2], (BopTarget{1, 1, 2, 1}));
    EXPECT_EQ(targets[3], (BopTarget{2, 0, 1, 1}));
}

TEST(BopWriter, SetsSplitsAndScenesCanBeOpenedAlone) {
    const TestFolder folder;
    write_set(folder / "set", 3, {.split = "train_pbr", .images_per_scene = 2});
    const DataSet whole = open_data_set(folder / "set");
    EXPECT_EQ(whole.scenes.size(), 3U);
    EXPECT_EQ(whole.bop_targets.size(), 5U);
    const DataSet split = open_data_set(folder / "set/train_pbr/");
    EXPECT_EQ(split.scenes.size(), 3U);
    EXPECT_EQ(split.models.size(), 2U);
    EXPECT_EQ(split.models[1].name, "ball");
    const DataSet scene = open_data_set(folder / "set/train_pbr/000002");
    ASSERT_EQ(scene.scenes.size(), 1U);
    EXPECT_EQ(scene.scenes[0].scene, 2);
    EXPECT_FALSE(scene.models[0].file.empty());
}

TEST(BopWriter, MeasuresMasksAsTheToolkitDoes) {
    const BopImage image = make_image(1);
    const BopObject& seen = image.objects[0];
    EXPECT_EQ(seen.pixels_all, 8);
    EXPECT_EQ(seen.pixels_visible, 2);
    EXPECT_EQ(seen.pixels_valid, 7);  // pixel 21 has no depth
    EXPECT_EQ(seen.visible_fraction, 0.25);
    EXPECT_EQ(seen.box_all, (PixelBox{2, 1, 3, 1}));
    EXPECT_EQ(seen.box_visible, (PixelBox{3, 1, 1, 0}));
    EXPECT_EQ(image.objects[1].visible_fraction, 0.0);
    EXPECT_EQ(image.objects[1].box_all, PixelBox{});
    EXPECT_EQ(image.objects[1].pixels_all, 8);
}

TEST(BopWriter, OrderAndThreadsDoNotMatter) {
    const TestFolder folder;
    write_set(folder / "one", 6, {.images_per_scene = 4});
    const std::vector<BopModel> models = make_models();
    BopWriter writer(folder / "many", models, Unit::meter, {.images_per_scene = 4});
    parallel_for(6, [&](std::size_t i) { writer.write(i, make_image(static_cast<int>(i))); });
    writer.finish();
    int files = 0;
    for (const auto& item : std::filesystem::recursive_directory_iterator(folder / "one")) {
        if (!item.is_regular_file()) continue;
        const auto other = folder / "many" / item.path().lexically_relative(folder / "one");
        EXPECT_EQ(load_text(item.path()), load_text(other)) << other;
        ++files;
    }
    EXPECT_EQ(files, 2 * 3 + 2 + 2 * 3 + 6 + 2 * 12);
}

TEST(BopWriter, RejectsWhatDoesNotFit) {
    const TestFolder folder;
    const std::vector<BopModel> models = make_models();
    EXPECT_THROW(BopWriter(folder / "a", {}, Unit::meter), InvalidInput);
    EXPECT_THROW(BopWriter(folder / "a", models, Unit::meter, {.split = "../x"}), InvalidInput);
    EXPECT_THROW(BopWriter(folder / "a", models, Unit::meter, {.images_per_scene = 0}),
                 InvalidInput);
    EXPECT_THROW(BopWriter(folder / "a", models, Unit::meter, {.depth_scale = 0.0}), InvalidInput);
    save(folder / "file", "");
    EXPECT_THROW(BopWriter(folder.path(), models, Unit::meter), FileError);
    BopWriter writer(folder / "set", models, Unit::meter);
    EXPECT_THROW(writer.finish(), InvalidInput);
    const auto rejected = [&](const auto& change) {
        BopImage image = make_image(0);
        change(image);
        EXPECT_THROW(writer.write(0, image), InvalidInput);
    };
    rejected([](BopImage& image) { image.depth.pop_back(); });
    rejected([](BopImage& image) { image.depth[3] = 6554.0F; });
    rejected([](BopImage& image) { image.depth[3] = -1.0F; });
    rejected([](BopImage& image) { image.depth[3] = std::numeric_limits<float>::infinity(); });
    rejected([](BopImage& image) { image.camera.width = 0; });
    rejected([](BopImage& image) { image.masks.pop_back(); });
    rejected([](BopImage& image) { image.masks[0].all.pop_back(); });
    rejected([](BopImage& image) { image.objects[0].number = 3; });
    rejected([](BopImage& image) { image.objects[0].T_camera_model(0, 3) = std::nan(""); });
    writer.write(0, make_image(0));
    EXPECT_THROW(writer.write(0, make_image(0)), InvalidInput);
    writer.finish();
    EXPECT_EQ(open_data_set(folder / "set").scenes.size(), 1U);
}

}  // namespace
}  // namespace ostraka
