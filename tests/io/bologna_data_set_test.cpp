// SPDX-License-Identifier: Apache-2.0
#include "io/data_set_testing.hpp"
#include "mesh/test_meshes.hpp"
#include "ostraka/io/data_set.hpp"
#include "ostraka/io/ini_file.hpp"
#include "ostraka/io/mesh_file.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

const std::string kConfiguration =
    "[MODELS]\r\n\r\nNUMBER = 2\r\n; comment\r\n"
    "MODEL_0 = \"/3D models/Stanford/bunny/bun_zipper.ply\" \r\n"
    "MODEL_0_GROUNDTRUTH = \"/3D models/Retrieval/Scene0-rs0.xf\"\r\n"
    "MODEL_1 = C:\\data\\xyzrgb_dragon_vr3.ply\r\n"
    "MODEL_1_GROUNDTRUTH = C:\\data\\Scene0-rs1.xf\r\n"
    "[scene]\r\nPATH = \"/3D models/Stanford/Retrieval/Scene0.ply\"\r\n";

void save_bologna(const TestFolder& folder) {
    save_at(folder / "retrieval" / "ConfigScene0.ini", kConfiguration);
    save(folder / "retrieval" / "Scene0-rs0.xf", kPose);
    save(folder / "retrieval" / "Scene0-rs1.xf", kPose);
    save(folder / "retrieval" / "Scene0_0.5.xyz", kPoint);
    save(folder / "retrieval" / "Scene0_0.1.xyz", kPoint);
    save(folder / "retrieval" / "Scene01.xyz", kPoint);  // of another scene
    std::filesystem::create_directories(folder / "models");
    write_mesh(folder / "models" / "bunny.ply", test_meshes::box({1, 1, 1}));
}

TEST(BolognaDataSet, FindsFilesByName) {
    const TestFolder folder;
    save_bologna(folder);
    const DataSet set = open_data_set(folder.path());
    EXPECT_EQ(set.kind, DataSetKind::bologna);
    EXPECT_EQ(set.unit, Unit::meter);
    ASSERT_EQ(set.models.size(), 2U);
    EXPECT_EQ(set.models[0].name, "asian_dragon");
    EXPECT_TRUE(set.models[0].file.empty());
    EXPECT_EQ(set.models[1].name, "bunny");
    EXPECT_EQ(set.models[1].file, folder / "models" / "bunny.ply");
    ASSERT_EQ(set.scenes.size(), 2U);
    EXPECT_EQ(set.scenes[0].name, "Scene0_0.1");
    EXPECT_EQ(set.scenes[1].name, "Scene0_0.5");
    EXPECT_FALSE(set.scenes[0].viewpoint.has_value());
    ASSERT_EQ(set.scenes[1].objects.size(), 2U);
    EXPECT_EQ(set.models[set.scenes[1].objects[0].model].name, "bunny");
    EXPECT_EQ(read_scan(set.scenes[1]).size(), 1U);
    std::filesystem::remove(folder / "retrieval" / "Scene0_0.1.xyz");
    std::filesystem::remove(folder / "retrieval" / "Scene0_0.5.xyz");
    const DataSet truth_only = open_data_set(folder.path());
    ASSERT_EQ(truth_only.scenes.size(), 1U);
    EXPECT_EQ(truth_only.scenes[0].name, "Scene0");
    EXPECT_TRUE(truth_only.scenes[0].scan.empty());
    std::filesystem::remove(folder / "retrieval" / "Scene0-rs1.xf");
    EXPECT_THROW(open_data_set(folder.path()), FileError);
}

TEST(BolognaDataSet, NamesAreUniqueAmongFolders) {
    const TestFolder folder;
    save_bologna(folder);
    std::filesystem::copy(folder / "retrieval", folder / "views");
    const DataSet set = open_data_set(folder.path());
    ASSERT_EQ(set.scenes.size(), 4U);
    EXPECT_EQ(set.scenes[0].name, "retrieval/Scene0_0.1");
    EXPECT_EQ(set.scenes[3].name, "views/Scene0_0.5");
    EXPECT_EQ(set.scenes[3].scan, folder / "views" / "Scene0_0.5.xyz");
}

TEST(BolognaDataSet, RejectsBadConfigurations) {
    const TestFolder folder;
    save_bologna(folder);
    const auto rejected = [&](const std::string& from, const std::string& to) {
        save(folder / "retrieval" / "ConfigScene0.ini", replaced(kConfiguration, from, to));
        EXPECT_THROW(open_data_set(folder.path()), FormatError) << to;
    };
    rejected("NUMBER = 2", "NUMBER = two");
    rejected("NUMBER = 2", "NUMBER = -2");
    rejected("NUMBER = 2", "NUMBER = 2000000000");
    rejected("NUMBER = 2", "NUMBER = 3");
    rejected("NUMBER = 2", "NUMBER");
    rejected("NUMBER = 2", "NUMBER = \"2");
    rejected("NUMBER = 2", "NUMBER = 2\nnumber = 2");
    rejected("[MODELS]", "[MODELS");
    rejected("PATH", "PFAD");
    rejected("MODEL_1 ", "MODEL_X ");
}

TEST(IniFile, SurvivesDamage) {
    const auto parse = [](const std::string& text) {
        return parse_ini(bytes_of(text), "test.ini");
    };
    EXPECT_EQ(parse(kConfiguration).at("MODELS/MODEL_1"), "C:\\data\\xyzrgb_dragon_vr3.ply");
    EXPECT_EQ(parse(kConfiguration).at("SCENE/PATH"), "/3D models/Stanford/Retrieval/Scene0.ply");
    EXPECT_EQ(parse("a=\nb = \"\"\n").at("/B"), "");
    for (std::size_t length = 0; length < kConfiguration.size(); ++length) {
        problem_of(parse, kConfiguration.substr(0, length));
    }
    EXPECT_NE(problem_of(parse, "[A]\nx").find("line 2"), std::string::npos);
}

TEST_F(RealDataSets, BolognaIsWhole) {
    const DataSet set = open_data_set(folder_ / "bologna");
    EXPECT_EQ(set.kind, DataSetKind::bologna);
    ASSERT_EQ(set.scenes.size(), 9U);
    ASSERT_EQ(set.models.size(), 6U);
    for (const RecordedModel& model : set.models) EXPECT_FALSE(model.file.empty()) << model.name;
    // Scenes are whole models: moved by the truth, the model's middle is the scene's.
    for (const RecordedScene& scene : set.scenes) {
        ASSERT_EQ(scene.objects.size(), 1U);
        const TriangleMesh mesh = read_mesh(set.models[scene.objects[0].model].file);
        const Vec3d middle = scene.objects[0].T_scene_model * centroid(mesh.vertices);
        EXPECT_LT((middle - centroid(read_scan(scene).points)).norm(), 0.01) << scene.name;
    }
}

}  // namespace
}  // namespace ostraka
