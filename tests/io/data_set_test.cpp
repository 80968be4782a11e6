// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/data_set.hpp"

#include "io/data_set_testing.hpp"
#include "mesh/test_meshes.hpp"
#include "ostraka/io/folder_files.hpp"
#include "ostraka/io/mesh_file.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

TEST(FolderFiles, NamesSortAsPeopleSortThem) {
    EXPECT_TRUE(natural_less("rs2", "rs10"));
    EXPECT_FALSE(natural_less("rs10", "rs2"));
    EXPECT_TRUE(natural_less("Scene3_0.1", "Scene3_0.5"));
    EXPECT_TRUE(natural_less("a", "ab"));
    EXPECT_TRUE(natural_less("a01", "a1"));
    EXPECT_FALSE(natural_less("a1", "a01"));
    EXPECT_FALSE(natural_less("a1", "a1"));
    EXPECT_TRUE(natural_less("a99999999999999999999998", "a99999999999999999999999"));
    EXPECT_EQ(name_key("T-rex 2."), "trex2");
}

TEST(DataSet, SaysWhatWasSought) {
    const TestFolder folder;
    try {
        open_data_set(folder.path());
        FAIL();
    } catch (const InvalidInput& error) {
        for (const char* word : {"scene_gt.json", "Config*.ini", "-rsNUMBER.xf", "BOP", "UWA"}) {
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word;
        }
    }
    EXPECT_THROW(open_data_set(folder / "none"), FileError);
    save(folder / "file", "");
    EXPECT_THROW(open_data_set(folder / "file"), FileError);
}

TEST(DataSet, KindsHaveNames) {
    EXPECT_EQ(data_set_kind_name(DataSetKind::uwa), "uwa");
    EXPECT_EQ(data_set_kind_name(DataSetKind::bologna), "bologna");
    EXPECT_EQ(data_set_kind_name(DataSetKind::bop), "bop");
    EXPECT_EQ(data_set_kind_name(DataSetKind::ostraka), "ostraka");
}

// As `ostraka simulate` writes it.
const std::string kSimulated = R"({"scene": "scene_0002.xyz", "unit": "mm", "objects": [
  {"model": "cam", "T_scene_model": [1,0,0,5, 0,1,0,6, 0,0,1,7, 0,0,0,1],
   "visible_fraction": 0.25},
  {"model": "arm", "T_scene_model": [1,0,0,5, 0,1,0,6, 0,0,1,7, 0,0,0,1]}]})";

void save_simulated(const TestFolder& folder) {
    save(folder / "scene_0002.json", kSimulated);
    save(folder / "scene_0002.xyz", kPoint);
    save(folder / "scene_0010.json", R"({"scene": "scene_0010.png", "unit": "mm", "objects": []})");
    const std::vector<std::uint16_t> depths = {0, 1000, 2000, 65535};
    write_depth_png16(folder / "scene_0010.png", 2, 2, depths);
    DepthCamera camera{{2, 2, 100.0, 200.0, 0.5, 0.5}, 1e-4, Unit::meter};
    write_camera_json(folder / "camera.json", camera);
    write_mesh(folder / "arm.stl", test_meshes::box({1, 1, 1}));
}

TEST(OstrakaDataSet, CloudsAndDepthImagesAreRead) {
    const TestFolder folder;
    save_simulated(folder);
    save(folder / "table.json", replaced(kSimulated, "scene_0002", "table"));
    save(folder / "table.xyz", kPoint);
    save(folder / "notes.json", "[");  // beside no scan
    const DataSet set = open_data_set(folder.path());
    EXPECT_EQ(set.kind, DataSetKind::ostraka);
    EXPECT_EQ(set.unit, Unit::millimeter);
    ASSERT_EQ(set.models.size(), 2U);
    EXPECT_EQ(set.models[0].name, "arm");
    EXPECT_EQ(set.models[0].file, folder / "arm.stl");
    EXPECT_TRUE(set.models[1].file.empty());
    ASSERT_EQ(set.scenes.size(), 3U);
    EXPECT_EQ(set.scenes[0].name, "scene_0002");
    EXPECT_EQ(set.scenes[2].name, "table");
    EXPECT_EQ(set.scenes[0].objects[0].visible_fraction, 0.25);
    EXPECT_EQ(set.scenes[0].objects[0].model, 1U);
    EXPECT_EQ(set.scenes[0].objects[1].visible_fraction, -1.0);
    EXPECT_EQ(read_scan(set.scenes[0]).points[0], Vec3f(1, 2, 3));
    const PointCloud cloud = read_scan(set.scenes[1]);
    ASSERT_EQ(cloud.size(), 4U);
    EXPECT_TRUE(cloud.organized());
    EXPECT_TRUE(std::isnan(cloud.points[0].x()));
    // 1000 steps of 0.1 mm; the camera says meters, the set millimeters.
    EXPECT_LT((cloud.points[1] - Vec3f(0.5F, -0.25F, 100.0F)).norm(), 1e-4F);
    EXPECT_LT((cloud.points[2] - Vec3f(-1.0F, 0.5F, 200.0F)).norm(), 1e-4F);
}

TEST(OstrakaDataSet, RejectsWhatIsNotTheFormat) {
    const TestFolder folder;
    save_simulated(folder);
    for (std::size_t length = 0; length < kSimulated.size(); ++length) {
        save(folder / "scene_0002.json", kSimulated.substr(0, length));
        EXPECT_THROW(open_data_set(folder.path()), FormatError) << length;
    }
    for (const auto& [from, to] :
         std::vector<std::array<std::string, 2>>{{"\"mm\"", "\"parsec\""},
                                                 {"\"mm\"", "\"m\""},  // the other file says mm
                                                 {"\"mm\"", "5"},
                                                 {"\"cam\"", "\"\""},
                                                 {"\"cam\"", "5"},
                                                 {"0.25", "1.25"},
                                                 {"0.25", "\"0.25\""},
                                                 {"0,0,0,1]", "0,0,0,2]"},
                                                 {"[1,0,0,5", "[2,0,0,5"},
                                                 {"[1,0,0,5", "[1,0,5"},
                                                 {"T_scene_model", "T"},
                                                 {"objects", "things"}}) {
        save(folder / "scene_0002.json", replaced(kSimulated, from, to));
        EXPECT_THROW(open_data_set(folder.path()), FormatError) << to;
    }
    // A scan is taken from beside the truth only.
    save(folder / "scene_0002.json", replaced(kSimulated, "scene_0002.xyz", "/etc/passwd"));
    EXPECT_TRUE(open_data_set(folder.path()).scenes[0].scan.empty());
    std::filesystem::remove(folder / "camera.json");
    EXPECT_THROW(open_data_set(folder.path()), FileError);
}

TEST(DataSet, DepthImagesMustFitTheirCamera) {
    const TestFolder folder;
    save_simulated(folder);
    write_camera_json(folder / "camera.json", {{3, 2, 100.0, 100.0, 1.0, 0.5}, 1.0, {}});
    const DataSet set = open_data_set(folder.path());
    EXPECT_THROW(read_scan(set.scenes[1]), FormatError);
    RecordedScene scene = set.scenes[1];
    scene.scan = folder / "depth.tif";
    EXPECT_THROW(read_scan(scene), InvalidInput);
}

// BOP's sets differ in what they hold.
TEST(BopDataSet, PartsMayBeMissing) {
    const TestFolder folder;
    const BopObject object{.number = 5};
    BopScene scene;
    scene.cameras = {{0, {}}, {7, {}}};
    scene.objects[7] = {object};
    std::filesystem::create_directories(folder / "test_kinect/000002/depth");
    std::filesystem::create_directories(folder / "test_laser/000002");
    std::filesystem::create_directories(folder / "train/000001");
    for (const char* place : {"test_kinect/000002", "test_laser/000002", "train/000001"}) {
        write_bop_scene(folder / place, scene);
    }
    save(folder / "test_kinect/000002/depth/000007.tif", "II");
    const DataSet set = open_data_set(folder.path());
    ASSERT_EQ(set.scenes.size(), 4U);  // train is left out where there is test
    EXPECT_EQ(set.scenes[0].name, "test_kinect/000002/000000");
    EXPECT_FALSE(set.scenes[0].truth_known);
    EXPECT_TRUE(set.scenes[0].scan.empty());
    EXPECT_EQ(set.scenes[3].name, "test_laser/000002/000007");
    EXPECT_EQ(set.scenes[3].objects.size(), 1U);
    EXPECT_EQ(set.scenes[1].depth->camera.width, 0);
    EXPECT_THROW(read_scan(set.scenes[1]), InvalidInput);  // TIFF
    ASSERT_EQ(set.models.size(), 1U);
    EXPECT_EQ(set.models[0].name, "obj_000005");
    EXPECT_EQ(set.models[0].number, 5);
    EXPECT_TRUE(set.models[0].file.empty());
    EXPECT_EQ(open_data_set(folder / "train").scenes[1].name, "000001/000007");
}

}  // namespace
}  // namespace ostraka
