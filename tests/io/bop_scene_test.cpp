// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/bop_scene.hpp"

#include "io/io_testing.hpp"
#include "mesh/test_meshes.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

// In the manner of published files: more keys than read, leading zeros nowhere, floats for counts.
const std::string kCamera = R"({
  "3": {"cam_K": [572.4114, 0.0, 325.2611, 0.0, 573.57043, 242.04899, 0.0, 0.0, 1.0],
        "depth_scale": 0.1, "cam_R_w2c": [1, 0], "view_level": 4},
  "12": {"cam_K": [572, 0, 325, 0, 573, 242, 0, 0, 1], "depth_scale": 1.0}
})";
const std::string kTruth = R"({
  "3": [{"cam_R_m2c": [0.09630630, 0.99404401, 0.05100790, 0.57332098, -0.01350810, -0.81922001,
                       -0.81365103, 0.10814000, -0.57120699],
         "cam_t_m2c": [-105.3577515, -117.52119142, 1014.8770132], "obj_id": 1},
        {"cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [0, 0, 500], "obj_id": 7}],
  "12": []
})";
const std::string kInfo = R"({
  "3": [{"bbox_obj": [244, 150, 44, 58], "bbox_visib": [245, 150, 43, 58], "px_count_all": 1609,
         "px_count_valid": 1522.0, "px_count_visib": 1514, "visib_fract": 0.9409571162212554},
        {"bbox_obj": [-1, -1, -1, -1], "visib_fract": 0.0}],
  "12": [], "99": [5]
})";

void save_published(const TestFolder& folder) {
    save(folder / "scene_camera.json", kCamera);
    save(folder / "scene_gt.json", kTruth);
    save(folder / "scene_gt_info.json", kInfo);
}

BopScene read_with(const std::string& file, const std::string& text) {
    const TestFolder folder;
    save_published(folder);
    save(folder / file, text);
    return read_bop_scene(folder.path());
}

TEST(BopScene, ReadsWhatIsPublished) {
    const TestFolder folder;
    save_published(folder);
    const BopScene scene = read_bop_scene(folder.path());
    EXPECT_TRUE(scene.truth_known);
    ASSERT_EQ(scene.cameras.size(), 2U);
    EXPECT_EQ(scene.cameras.at(3).fy, 573.57043);
    EXPECT_EQ(scene.cameras.at(3).cx, 325.2611);
    EXPECT_EQ(scene.cameras.at(3).depth_scale, 0.1);
    EXPECT_TRUE(scene.objects.at(12).empty());
    const BopObject& object = scene.objects.at(3).at(0);
    EXPECT_EQ(object.number, 1);
    EXPECT_EQ(object.T_camera_model.translation().z(), 1014.8770132);
    EXPECT_NEAR(object.T_camera_model(0, 1), 0.99404401, 1e-6);
    EXPECT_EQ(object.box_all, (PixelBox{244, 150, 44, 58}));
    EXPECT_EQ(object.box_visible, (PixelBox{245, 150, 43, 58}));
    EXPECT_EQ(object.pixels_all, 1609);
    EXPECT_EQ(object.pixels_valid, 1522);
    EXPECT_EQ(object.pixels_visible, 1514);
    EXPECT_EQ(object.visible_fraction, 0.9409571162212554);
    EXPECT_EQ(scene.objects.at(3).at(1).visible_fraction, 0.0);
    EXPECT_EQ(scene.objects.at(3).at(1).pixels_all, -1);
    EXPECT_EQ(scene.objects.at(3).at(1).box_visible, PixelBox{});
}

TEST(BopScene, TruthAndInfoMayBeMissing) {
    const TestFolder folder;
    save_published(folder);
    std::filesystem::remove(folder / "scene_gt_info.json");
    EXPECT_EQ(read_bop_scene(folder.path()).objects.at(3).at(0).visible_fraction, -1.0);
    std::filesystem::remove(folder / "scene_gt.json");
    EXPECT_FALSE(read_bop_scene(folder.path()).truth_known);
    EXPECT_TRUE(read_bop_scene(folder.path()).objects.empty());
    std::filesystem::remove(folder / "scene_camera.json");
    EXPECT_THROW(read_bop_scene(folder.path()), FileError);
}

TEST(BopScene, WritesWhatItReads) {
    BopScene scene;
    for (int image = 0; image < 12; ++image) {
        scene.cameras[image] = {.fx = 500.0 / 3.0, .fy = 501.1, .cx = 319.5, .cy = 1e-3 * image};
        scene.objects[image] = {};
        for (int i = 0; i < image % 4; ++i) {
            BopObject object{.number = i + 1, .visible_fraction = i / 3.0, .pixels_all = 9};
            object.T_camera_model = test_meshes::random_pose(static_cast<std::uint64_t>(i), 999.0);
            object.box_all = {-5, 2, 30, 40};
            scene.objects[image].push_back(object);
        }
    }
    const TestFolder folder;
    write_bop_scene(folder.path(), scene);
    const BopScene read = read_bop_scene(folder.path());
    EXPECT_TRUE(read.truth_known);
    ASSERT_EQ(read.cameras.size(), scene.cameras.size());
    for (const auto& [image, camera] : scene.cameras) {
        EXPECT_EQ(read.cameras.at(image).fx, camera.fx);
        EXPECT_EQ(read.cameras.at(image).fy, camera.fy);
        EXPECT_EQ(read.cameras.at(image).cx, camera.cx);
        EXPECT_EQ(read.cameras.at(image).cy, camera.cy);
        EXPECT_EQ(read.cameras.at(image).depth_scale, camera.depth_scale);
        const std::vector<BopObject>& objects = scene.objects.at(image);
        ASSERT_EQ(read.objects.at(image).size(), objects.size());
        for (std::size_t i = 0; i < objects.size(); ++i) {
            const BopObject& other = read.objects.at(image)[i];
            EXPECT_EQ(other.number, objects[i].number);
            EXPECT_EQ(other.T_camera_model.translation(), objects[i].T_camera_model.translation());
            EXPECT_LT((other.T_camera_model.linear() - objects[i].T_camera_model.linear()).norm(),
                      1e-14);
            EXPECT_EQ(other.visible_fraction, objects[i].visible_fraction);
            EXPECT_EQ(other.pixels_all, objects[i].pixels_all);
            EXPECT_EQ(other.pixels_visible, -1);
            EXPECT_EQ(other.box_all, objects[i].box_all);
        }
    }
    scene.cameras[0].fx = std::nan("");
    EXPECT_THROW(write_bop_scene(folder.path(), scene), InvalidInput);
}

TEST(BopScene, RejectsEveryTruncation) {
    for (std::size_t length = 0; length + 1 < kTruth.size(); ++length) {
        EXPECT_THROW(parse_scene_gt(bytes_of(kTruth.substr(0, length)), "t"), FormatError);
    }
    for (std::size_t length = 0; length + 1 < kCamera.size(); ++length) {
        EXPECT_THROW(parse_scene_camera(bytes_of(kCamera.substr(0, length)), "t"), FormatError);
    }
    auto objects = parse_scene_gt(bytes_of(kTruth), "t");
    for (std::size_t length = 0; length + 1 < kInfo.size(); ++length) {
        EXPECT_THROW(parse_scene_gt_info(bytes_of(kInfo.substr(0, length)), "t", objects),
                     FormatError);
    }
}

struct Damage {
    const char* file;
    const char* from;
    const char* to;
};

TEST(BopScene, RejectsWhatIsNotTheFormat) {
    const std::vector<Damage> damages = {
        {"scene_camera.json", "\"3\"", "\"three\""},
        {"scene_camera.json", "\"3\"", "\"-3\""},
        {"scene_camera.json", "\"3\"", "\"0012\""},  // twice
        {"scene_camera.json", "\"3\"", "\"4\""},     // truth without a camera
        {"scene_camera.json", "[572.4114,", "[-572.4114,"},
        {"scene_camera.json", "[572.4114, 0.0", "[572.4114, 1.0"},
        {"scene_camera.json", "[572.4114,", "["},
        {"scene_camera.json", "0.0, 0.0, 1.0]", "0.0, 0.0, 2.0]"},
        {"scene_camera.json", "cam_K", "K"},
        {"scene_camera.json", "\"depth_scale\": 0.1", "\"depth_scale\": 0"},
        {"scene_camera.json", "\"depth_scale\": 0.1", "\"depth_scale\": \"0.1\""},
        {"scene_camera.json", "\"depth_scale\": 0.1", "\"depth_scale\": 1e999"},
        {"scene_gt.json", "\"12\": []", "\"12\": {}"},
        {"scene_gt.json", "\"12\": []", "\"12\": [5]"},
        {"scene_gt.json", "\"12\": []", "\"12\": [[[[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]]]]"},
        {"scene_gt.json", "0.09630630", "0.5"},
        {"scene_gt.json", "[1, 0, 0, 0, 1, 0, 0, 0, 1]", "[1, 0, 0, 0, 1, 0, 0, 0, -1]"},
        {"scene_gt.json", "[1, 0, 0, 0, 1, 0, 0, 0, 1]", "[1, 0, 0, 0, 1, 0, 0, 0]"},
        {"scene_gt.json", "[0, 0, 500]", "[0, 500]"},
        {"scene_gt.json", "[0, 0, 500]", "[0, 0, 5e200]"},
        {"scene_gt.json", "\"obj_id\": 7", "\"obj_id\": 0"},
        {"scene_gt.json", "\"obj_id\": 7", "\"obj_id\": 1.5"},
        {"scene_gt.json", "\"obj_id\": 7", "\"obj_id\": null"},
        {"scene_gt_info.json", "\"12\": []", "\"12\": [{}]"},
        {"scene_gt_info.json", "0.9409571162212554", "1.1"},
        {"scene_gt_info.json", "0.9409571162212554", "-0.1"},
        {"scene_gt_info.json", "1609", "-1609"},
        {"scene_gt_info.json", "1609", "16.09"},
        {"scene_gt_info.json", "[245, 150, 43, 58]", "[245, 150, 43]"},
        {"scene_gt_info.json", "[245, 150, 43, 58]", "[245, 150, 43, 1e20]"},
    };
    for (const Damage& damage : damages) {
        const std::string file = damage.file;
        const std::string& sound = file == "scene_camera.json" ? kCamera
                                   : file == "scene_gt.json"   ? kTruth
                                                               : kInfo;
        EXPECT_THROW(read_with(file, replaced(sound, damage.from, damage.to)), FormatError)
            << file << ": " << damage.to;
    }
    for (const char* text : {"", "[]", "5", "null", "{\"1\": 5}"}) {
        EXPECT_THROW(read_with("scene_camera.json", text), FormatError) << text;
        EXPECT_THROW(read_with("scene_gt.json", text), FormatError) << text;
    }
}

TEST(BopScene, NamesImageAndObject) {
    const std::string text = replaced(kTruth, "\"obj_id\": 7", "\"obj_id\": -7");
    const auto parse = [](const std::string& bytes) {
        return parse_scene_gt(bytes_of(bytes), "scene_gt.json");
    };
    EXPECT_NE(problem_of(parse, text).find("image \"3\", object 1"), std::string::npos);
}

TEST(BopTargets, SurviveWritingAndReading) {
    const TestFolder folder;
    const std::vector<BopTarget> targets = {{48, 1, 5, 1}, {48, 36, 1, 2}, {2, 3, 30, 1}};
    write_bop_targets(folder / "t.json", targets);
    EXPECT_EQ(read_bop_targets(folder / "t.json"), targets);
    const std::string valid = load_text(folder / "t.json");
    for (std::size_t length = 0; length + 2 < valid.size(); ++length) {
        save(folder / "cut.json", valid.substr(0, length));
        EXPECT_THROW(read_bop_targets(folder / "cut.json"), FormatError);
    }
    for (const auto& [from, to] :
         std::vector<std::array<std::string, 2>>{{"\"im_id\": 1", "\"im_id\": -1"},
                                                 {"\"obj_id\": 5", "\"obj_id\": 0"},
                                                 {"\"im_id\": 1,", ""},
                                                 {"\"im_id\": 1", "\"im_id\": \"1\""}}) {
        save(folder / "bad.json", replaced(valid, from, to));
        EXPECT_THROW(read_bop_targets(folder / "bad.json"), FormatError) << to;
    }
    save(folder / "bad.json", "{}");
    EXPECT_THROW(read_bop_targets(folder / "bad.json"), FormatError);
    write_bop_targets(folder / "none.json", {});
    EXPECT_TRUE(read_bop_targets(folder / "none.json").empty());
}

}  // namespace
}  // namespace ostraka
