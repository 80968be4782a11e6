// SPDX-License-Identifier: Apache-2.0
// The real laser scan rs1 of the UWA data set: four objects, 67 to 85 % occluded. Mian, Bennamoun,
// Owens 2006. Set OSTRAKA_DATA to the folder of the data sets to run this.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "ostraka/io/cloud_file.hpp"
#include "ostraka/library/model_source.hpp"
#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

namespace fs = std::filesystem;

Pose read_pose(const fs::path& path) {
    std::ifstream stream(path);
    Pose T_scene_model = Pose::Identity();
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) {
            double value = 0.0;
            if (!(stream >> value)) ADD_FAILURE() << path << " is no 4 x 4 matrix";
            T_scene_model.matrix()(row, column) = value;
        }
    }
    return T_scene_model;
}

TEST(Uwa, AllFourObjectsOfRs1AreFoundAndNothingElse) {
    const char* data = std::getenv("OSTRAKA_DATA");
    if (data == nullptr) {
        GTEST_SKIP() << "set OSTRAKA_DATA to a folder with uwa/models, uwa/scenes/rs1.ply and "
                        "uwa/ground_truth (the UWA 3D object recognition data set)";
    }
    const fs::path folder = fs::path(data) / "uwa";
    std::vector<ModelSource> sources;
    for (const char* name : {"T-rex", "chef", "chicken", "parasaurolophus"}) {
        sources.push_back(load_model(folder / "models" / (std::string(name) + ".ply")));
    }
    const ModelLibrary library = build_library(sources);
    PointCloud scene = read_cloud(folder / "scenes/rs1.ply");
    scene.viewpoint = Vec3f::Zero();
    const Recognition result = recognize(library, scene);
    std::size_t found = 0;
    for (const RecognizedObject& object : result.objects) {
        const Pose truth = read_pose(folder / "ground_truth" / (object.model + "-rs1.xf"));
        const double error = recognition_testing::pose_error(library, object.model_index, truth,
                                                             object.T_scene_model);
        EXPECT_LT(error, 0.10) << object.model << " reported wrongly";
        found += error < 0.10 ? 1 : 0;
        RecordProperty(object.model, std::to_string(error));
    }
    EXPECT_EQ(found, 4U);
}

}  // namespace
}  // namespace ostraka
