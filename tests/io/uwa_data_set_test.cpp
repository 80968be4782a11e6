// SPDX-License-Identifier: Apache-2.0
#include "io/data_set_testing.hpp"
#include "mesh/test_meshes.hpp"
#include "ostraka/io/data_set.hpp"
#include "ostraka/io/mesh_file.hpp"
#include "ostraka/io/uwa_occlusion.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

// UWA, with the folders of the download or without.
void save_uwa(const TestFolder& folder, bool flat) {
    const auto at = [&](const char* place, const char* name) {
        return flat ? folder / name : folder / place / name;
    };
    for (const char* scene : {"rs1", "rs2", "rs10"}) {
        save_at(at("truth", (std::string("T-rex-") + scene + ".xf").c_str()), kPose);
    }
    save_at(at("truth", "parasaurolophus-rs2.xf"), kPose);
    save_at(at("truth", "chef-rs2.xf"), kPose);
    save_at(at("truth", "occlusion.txt"),
            "scene\tobject\t% occlusion\n1\ttrex\t77.5\n2\tpara\t100\r\n2\tchef\t0\n99\tchef\t5\n");
    std::filesystem::create_directories(at("scenes", "x").parent_path());
    std::filesystem::create_directories(at("models", "x").parent_path());
    save(at("scenes", "rs2.xyz"), kPoint);
    save(at("scenes", "rs11.xyz"), kPoint);
    write_mesh(at("models", "trex_high.ply"), test_meshes::box({1, 1, 1}));
    write_mesh(at("models", "cheff.ply"), test_meshes::box({1, 1, 1}));
    write_mesh(at("models", "rhino.ply"), test_meshes::box({1, 1, 1}));
}

TEST(UwaDataSet, IsReadAsDownloadedOrFlat) {
    for (const bool flat : {false, true}) {
        const TestFolder folder;
        save_uwa(folder, flat);
        const DataSet set = open_data_set(folder.path());
        EXPECT_EQ(set.kind, DataSetKind::uwa);
        EXPECT_EQ(set.unit, Unit::millimeter);
        ASSERT_EQ(set.models.size(), 4U);
        EXPECT_EQ(set.models[0].name, "T-rex");
        EXPECT_EQ(set.models[0].file.filename(), "trex_high.ply");
        EXPECT_EQ(set.models[1].file.filename(), "cheff.ply");
        EXPECT_EQ(set.models[2].name, "parasaurolophus");
        EXPECT_TRUE(set.models[2].file.empty());  // absent; its truth stays
        EXPECT_EQ(set.models[3].name, "rhino");
        ASSERT_EQ(set.scenes.size(), 4U);
        EXPECT_EQ(set.scenes[1].name, "rs2");
        EXPECT_EQ(set.scenes[2].name, "rs10");
        EXPECT_EQ(set.scenes[2].image, 2);
        EXPECT_EQ(set.scenes[0].viewpoint, Vec3f::Zero());
        EXPECT_TRUE(set.scenes[0].scan.empty());
        EXPECT_THROW(read_scan(set.scenes[0]), InvalidInput);
        EXPECT_EQ(read_scan(set.scenes[1]).points[0], Vec3f(1, 2, 3));
        EXPECT_FALSE(set.scenes[3].truth_known);  // rs11 has a scan alone
        EXPECT_NEAR(set.scenes[0].objects[0].visible_fraction, 0.225, 1e-12);
        EXPECT_EQ(set.scenes[2].objects[0].visible_fraction, -1.0);
        ASSERT_EQ(set.scenes[1].objects.size(), 3U);
        for (const RecordedObject& object : set.scenes[1].objects) {
            const std::string name = set.models[object.model].name;
            EXPECT_EQ(object.visible_fraction, name == "chef" ? 1.0 : name == "T-rex" ? -1.0 : 0.0);
            EXPECT_EQ(object.T_scene_model.translation(), Eigen::Vector3d(5, 6, 7));
        }
    }
}

TEST(UwaDataSet, RejectsBadOcclusion) {
    const auto parse = [](const std::string& text) {
        return parse_uwa_occlusion(bytes_of(text), "occlusion.txt");
    };
    const std::string head = "scene object %\n";
    EXPECT_EQ(parse(head + "1 chef 5").size(), 1U);
    EXPECT_EQ(parse("1 chef 5\n\n2 chef 6\n").size(), 2U);
    EXPECT_NE(problem_of(parse, head + "x chef 5").find("line 2"), std::string::npos);
    for (const char* row : {"1 chef", "1 chef 5 6", "1 chef x", "1 chef -1", "1 chef 101",
                            "1 chef nan", "-1 chef 5", "1.5 chef 5"}) {
        EXPECT_NE(problem_of(parse, head + row), "") << row;
    }
    const TestFolder folder;
    save_uwa(folder, true);
    save(folder / "chef-rs2.xf", kPose.substr(0, 20));
    EXPECT_THROW(open_data_set(folder.path()), FormatError);
}

TEST_F(RealDataSets, UwaIsWhole) {
    const DataSet set = open_data_set(folder_ / "uwa");
    EXPECT_EQ(set.kind, DataSetKind::uwa);
    ASSERT_EQ(set.scenes.size(), 50U);
    EXPECT_EQ(set.scenes[9].name, "rs10");
    ASSERT_GE(set.models.size(), 4U);
    for (const RecordedModel& model : set.models) EXPECT_FALSE(model.file.empty()) << model.name;
    std::size_t objects = 0;
    for (const RecordedScene& scene : set.scenes) {
        for (const RecordedObject& object : scene.objects) {
            EXPECT_GT(object.visible_fraction, 0.0) << scene.name;
            EXPECT_LT(object.visible_fraction, 0.6) << scene.name;
            objects += 1;
        }
    }
    EXPECT_EQ(objects, 188U);
    for (const RecordedObject& object : set.scenes[0].objects) {
        if (set.models[object.model].name != "chef") continue;
        EXPECT_NEAR(object.visible_fraction, 1.0 - 0.772, 1e-12);
    }
    // The scan and a model in its true pose meet: the frames and units are the same.
    const PointCloud scan = read_scan(set.scenes[0]);
    EXPECT_EQ(scan.viewpoint, Vec3f::Zero());
    EXPECT_LT(centroid(scan.points).z(), -100.0);  // the sensor looks along -z
}

}  // namespace
}  // namespace ostraka
