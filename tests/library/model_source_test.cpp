// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/model_source.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "ostraka/base/error.hpp"
#include "ostraka/io/cloud_file.hpp"
#include "ostraka/io/mesh_file.hpp"
#include "ostraka/mesh/shape.hpp"
#include "ostraka/mesh/surface_samples.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

class ModelSourceTest : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("ostraka_model_source_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
        cloud_.points = sample_uniformly(truth_, 12'000).points;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path folder_;
    const TriangleMesh truth_ = testing::corner_model();
    PointCloud cloud_;
};

TEST_F(ModelSourceTest, OfFacesIsTheirMesh) {
    write_mesh(folder_ / "corner.ply", truth_);
    const ModelSource source = load_model(folder_ / "corner.ply");
    EXPECT_EQ(source.cloud_points, 0U);
    EXPECT_EQ(source.mesh.triangles.size(), truth_.triangles.size());
}

TEST_F(ModelSourceTest, OfPointsIsTheSurfaceAroundThemInEveryFormat) {
    write_cloud(folder_ / "corner.ply", cloud_);
    write_cloud(folder_ / "corner.PCD", cloud_);
    write_cloud(folder_ / "corner.xyz", cloud_);
    write_mesh(folder_ / "corner.obj", {.vertices = cloud_.points, .triangles = {}});
    write_mesh(folder_ / "corner.off", {.vertices = cloud_.points, .triangles = {}});
    // Faces that two boxes share are sampled, too, inside the model: they are no part of its shell.
    const MeshShape shape = measure(truth_);
    for (const char* name :
         {"corner.ply", "corner.PCD", "corner.xyz", "corner.obj", "corner.off"}) {
        const ModelSource source = load_model(folder_ / name);
        EXPECT_EQ(source.name, "corner");
        EXPECT_EQ(source.file, name);
        EXPECT_EQ(source.sha256.size(), 64U);
        EXPECT_EQ(source.cloud_points, cloud_.size()) << name;
        EXPECT_NEAR(source.cloud_spacing, std::sqrt(surface_area(truth_) / 12'000), 0.2);
        EXPECT_GT(source.mesh.triangles.size(), 10'000U);
        EXPECT_NEAR(measure(source.mesh).diameter, shape.diameter, 0.01 * shape.diameter);
    }
}

TEST_F(ModelSourceTest, WithoutSurfaceNamesTheFile) {
    cloud_.points.resize(3);
    write_cloud(folder_ / "few.pcd", cloud_);
    write_cloud(folder_ / "none.xyz", {});
    for (const char* name : {"few.pcd", "none.xyz"}) {
        try {
            load_model(folder_ / name);
            FAIL() << name;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace ostraka
