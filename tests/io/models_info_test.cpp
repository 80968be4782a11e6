// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/models_info.hpp"

#include "io/io_testing.hpp"
#include "mesh/test_meshes.hpp"
#include "ostraka/mesh/symmetry_poses.hpp"

namespace ostraka {
namespace {

using io_testing::load_text;
using io_testing::save;
using io_testing::TestFolder;

// In the manner of published files: a continuous axis, an identity, a turn in rounded numbers.
const std::string kPublished = R"({
  "1": {"diameter": 63.5, "min_x": -17.5, "min_y": -18, "min_z": -30.6, "size_x": 35.0,
        "size_y": 36, "size_z": 61.2,
        "symmetries_continuous": [{"axis": [0, 0, 2], "offset": [1, 2, 0]}]},
  "12": {"diameter": 10.5, "min_x": 0, "min_y": 0, "min_z": 0, "size_x": 1, "size_y": 2,
         "size_z": 3, "name": "box", "symmetries_discrete": [
          [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
          [-0.9999, 0.0013, 0, 4, -0.0013, -0.9999, 0, 6, 0, 0, 1.0001, 0, 0, 0, 0, 1]]},
  "3": {"diameter": 7, "min_x": 0, "min_y": 0, "min_z": 0, "size_x": 1, "size_y": 2, "size_z": 3,
        "unknown": [[[]]]}
})";

TEST(ModelsInfo, ReadsWhatBopPublishes) {
    const TestFolder folder;
    save(folder / "models_info.json", kPublished);
    const std::vector<ModelInfo> models = read_models_info(folder / "models_info.json");
    ASSERT_EQ(models.size(), 3U);
    EXPECT_EQ(models[0].number, 1);
    EXPECT_EQ(models[1].number, 3);
    EXPECT_EQ(models[2].number, 12);
    EXPECT_EQ(models[0].diameter, 63.5);
    EXPECT_EQ(models[0].low, Vec3d(-17.5, -18.0, -30.6));
    EXPECT_EQ(models[0].size, Vec3d(35.0, 36.0, 61.2));
    ASSERT_EQ(models[0].symmetry.axes.size(), 1U);
    EXPECT_EQ(models[0].symmetry.axes[0].direction, Vec3d(0, 0, 1));
    EXPECT_EQ(models[0].symmetry.axes[0].point, Vec3d(1, 2, 0));
    EXPECT_LT((models[0].symmetry.center - Vec3d(1, 2, 0)).norm(), 1e-9);
    EXPECT_FALSE(models[1].symmetry.any());
    EXPECT_EQ(models[2].name, "box");
    ASSERT_EQ(models[2].symmetry.turns.size(), 1U);
    const Mat3d turn = models[2].symmetry.turns[0].linear();
    EXPECT_LT((turn * turn.transpose() - Mat3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(turn(0, 1), 0.0013, 1e-5);
    EXPECT_EQ(models[2].symmetry.turns[0].translation(), Eigen::Vector3d(4, 6, 0));
}

TEST(ModelsInfo, WritesWhatItReads) {
    const TestFolder folder;
    Symmetry symmetry;
    symmetry.turns = {test_meshes::random_pose(1), test_meshes::random_pose(2)};
    symmetry.axes = {{Vec3d(1, 2, -2) / 3.0, Vec3d(0.1, 0.2, 0.3)}};
    std::vector<ModelInfo> models(2);
    models[0] = {.number = 2, .name = "a \"b\"", .diameter = 1.0 / 3.0, .symmetry = symmetry};
    models[0].low = Vec3d(-0.1, 1e-30, 12345.678);
    models[1] = {.number = 1, .diameter = 5.0};
    write_models_info(folder / "info.json", models);
    const std::vector<ModelInfo> read = read_models_info(folder / "info.json");
    ASSERT_EQ(read.size(), 2U);
    EXPECT_EQ(read[0].diameter, 5.0);
    EXPECT_EQ(read[1].name, "a \"b\"");
    EXPECT_EQ(read[1].diameter, 1.0 / 3.0);
    EXPECT_EQ(read[1].low, models[0].low);
    ASSERT_EQ(read[1].symmetry.turns.size(), 2U);
    for (std::size_t k = 0; k < 2; ++k) {
        const Mat4d difference = read[1].symmetry.turns[k].matrix() - symmetry.turns[k].matrix();
        EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-14);
    }
    EXPECT_EQ(read[1].symmetry.axes[0].point, symmetry.axes[0].point);
    // A model without symmetry has no key of that name, as toolkits ask whether it is there.
    const std::string text = load_text(folder / "info.json");
    EXPECT_EQ(text.find("symmetries"), text.rfind("symmetries_discrete"));
    EXPECT_GT(text.find("\"1\""), text.find("\"2\""));  // in the order given
}

TEST(ModelsInfo, MeasuresInMillimeters) {
    const TriangleMesh mesh = transformed(test_meshes::box({0.01F, 0.02F, 0.03F}),
                                          Pose(Eigen::Translation3d(0.1, 0.0, 0.0)));
    const Symmetry symmetry = find_symmetry(mesh);
    const ModelInfo info = model_info(7, "box", mesh, symmetry, Unit::meter);
    EXPECT_EQ(info.number, 7);
    EXPECT_NEAR(info.diameter, 2.0 * std::sqrt(1400.0), 1e-3);
    EXPECT_LT((info.low - Vec3d(90, -20, -30)).norm(), 1e-3);
    EXPECT_LT((info.size - Vec3d(20, 40, 60)).norm(), 1e-3);
    ASSERT_EQ(info.symmetry.turns.size(), 3U);
    EXPECT_LT((info.symmetry.center - Vec3d(100, 0, 0)).norm(), 0.2);
    for (const Pose& turn : info.symmetry.turns) {
        EXPECT_LT((turn * info.symmetry.center - info.symmetry.center).norm(), 1e-9);
    }
}

TEST(ModelsInfo, RejectsNumbersUsedTwice) {
    const TestFolder folder;
    std::vector<ModelInfo> models(2);
    EXPECT_THROW(write_models_info(folder / "info.json", models), InvalidInput);
    models[0].number = 0;
    EXPECT_THROW(write_models_info(folder / "info.json", models), InvalidInput);
    EXPECT_FALSE(std::filesystem::exists(folder / "info.json"));
}

TEST(ModelsInfo, RejectsMissingFiles) {
    const TestFolder folder;
    EXPECT_THROW(read_models_info(folder / "none.json"), FileError);
    EXPECT_THROW(read_models_info(folder.path()), FileError);
}

TEST(ModelsInfo, RejectsEveryTruncation) {
    const TestFolder folder;
    for (std::size_t length = 0; length + 1 < kPublished.size(); ++length) {
        save(folder / "cut.json", kPublished.substr(0, length));
        EXPECT_THROW(read_models_info(folder / "cut.json"), FormatError) << length;
    }
}

// Replaces one part of a sound file; every such file is unusable.
TEST(ModelsInfo, RejectsWhatIsNotTheFormat) {
    const TestFolder folder;
    const std::vector<std::array<std::string, 2>> changes = {
        {"\"1\":", "\"one\":"},
        {"\"1\":", "\"0\":"},
        {"\"1\":", "\"-1\":"},
        {"\"1\":", "\"1.5\":"},
        {"\"1\":", "\"99999999999\":"},
        {"\"1\":", "\"\":"},
        {"\"1\":", "\"003\":"},
        {"\"diameter\": 63.5", "\"diameter\": 0"},
        {"\"diameter\": 63.5", "\"diameter\": \"63.5\""},
        {"\"diameter\": 63.5", "\"diameter\": null"},
        {"\"diameter\": 63.5", "\"diameter\": 1e300"},
        {"\"diameter\": 63.5", "\"diameter\": 1e999"},
        {"\"diameter\": 63.5", "\"diameter\": NaN"},
        {"\"diameter\": 63.5,", ""},
        {"\"min_x\": -17.5,", ""},
        {"\"size_x\": 35.0", "\"size_x\": -35.0"},
        {"[0, 0, 2]", "[0, 0]"},
        {"[0, 0, 2]", "[0, 0, 0]"},
        {"[0, 0, 2]", "[0, 0, \"2\"]"},
        {"\"axis\"", "\"axes\""},
        {"\"offset\"", "\"off\""},
        {"[{\"axis\": [0, 0, 2], \"offset\": [1, 2, 0]}]", "{\"axis\": [0, 0, 2]}"},
        {"[{\"axis\": [0, 0, 2], \"offset\": [1, 2, 0]}]", "[5]"},
        {"0, 0, 0, 1]]", "0, 0, 0, 2]]"},
        {"0, 0, 0, 1]]", "0, 0, 1]]"},
        {"1.0001, 0,", "-1.0001, 0,"},  // a mirror image
        {"1.0001, 0,", "1.2, 0,"},
        {"\"name\": \"box\"", "\"name\": 5"},
        {"{\"diameter\": 7,", "{\"symmetries_discrete\": 3, \"diameter\": 7,"},
        {"[[[]]]", "[[[[[[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]]]]]]"},
    };
    for (const auto& [sound, broken] : changes) {
        std::string text = kPublished;
        const std::size_t at = text.find(sound);
        ASSERT_NE(at, std::string::npos) << sound;
        text.replace(at, sound.size(), broken);
        save(folder / "bad.json", text);
        EXPECT_THROW(read_models_info(folder / "bad.json"), FormatError) << broken;
    }
    for (const char* text : {"", "[]", "5", "null", "{\"1\": 5}", "{\"1\": []}"}) {
        save(folder / "bad.json", text);
        EXPECT_THROW(read_models_info(folder / "bad.json"), FormatError) << text;
    }
}

TEST(ModelsInfo, NamesTheModelThatIsWrong) {
    const TestFolder folder;
    std::string text = kPublished;
    text.replace(text.find("10.5"), 4, "-1");
    save(folder / "bad.json", text);
    try {
        read_models_info(folder / "bad.json");
        FAIL();
    } catch (const FormatError& error) {
        EXPECT_NE(std::string(error.what()).find("model \"12\""), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("bad.json"), std::string::npos);
    }
}

}  // namespace
}  // namespace ostraka
