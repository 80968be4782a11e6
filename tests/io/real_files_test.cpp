// SPDX-License-Identifier: Apache-2.0
// Files as others wrote them. Set OSTRAKA_DATA to the folder of the data sets to run these.
#include <cstdlib>

#include "io/io_testing.hpp"
#include "ostraka/io/cloud_file.hpp"
#include "ostraka/io/mesh_file.hpp"
#include "ostraka/mesh/repair.hpp"

namespace ostraka {
namespace {

class RealFiles : public ::testing::Test {
  protected:
    void SetUp() override {
        const char* data = std::getenv("OSTRAKA_DATA");
        if (data == nullptr) {
            GTEST_SKIP() << "set OSTRAKA_DATA to a folder with uwa/, bologna/, industrial/ and "
                            "kinect/ (UWA and Bologna data sets, NIST parts, PCL's Kinect clouds)";
        }
        folder_ = data;
    }
    std::filesystem::path folder_;
};

TEST_F(RealFiles, ModelsCanBeReadAndRepaired) {
    int files = 0;
    for (const char* folder : {"uwa/models", "bologna/models", "industrial/stl"}) {
        for (const auto& entry : std::filesystem::directory_iterator(folder_ / folder)) {
            const std::string extension = entry.path().extension();
            if (extension != ".ply" && extension != ".stl") {
                continue;
            }
            const TriangleMesh mesh = read_mesh(entry.path());
            io_testing::expect_well_formed(mesh);
            EXPECT_GT(repair(mesh).mesh.triangles.size(), 50U) << entry.path();
            ++files;
        }
    }
    EXPECT_GT(files, 0);
}

TEST_F(RealFiles, CountsAreTheHeaders) {
    EXPECT_EQ(read_mesh(folder_ / "uwa/models/chef.ply").triangles.size(), 32270U);
    EXPECT_EQ(read_mesh(folder_ / "bologna/models/dragon.ply").vertices.size(), 100207U);
    EXPECT_EQ(read_cloud(folder_ / "uwa/scenes/rs1.ply").size(), 289541U);
    // 5484 = 84 + 50 * 108
    EXPECT_EQ(read_mesh(folder_ / "industrial/stl/nist_battery.stl").triangles.size(), 108U);
}

TEST_F(RealFiles, KinectCloudIsOrganizedWithHoles) {
    const CloudFile file = read_cloud_file(folder_ / "kinect/milk_cartoon_all_small_clorox.pcd");
    EXPECT_FALSE(file.has_viewpoint);
    EXPECT_EQ(file.cloud.width, 640);
    EXPECT_EQ(file.cloud.height, 480);
    EXPECT_EQ(file.cloud.colors.size(), 307200U);
    const PointCloud valid = remove_invalid(file.cloud);
    EXPECT_LT(valid.size(), file.cloud.size());
    // A Kinect sees from about 0.4 to 10 m.
    for (const Vec3f& point : valid.points) {
        ASSERT_GT(point.z(), 0.3F);
        ASSERT_LT(point.z(), 12.0F);
    }
    EXPECT_EQ(read_cloud(folder_ / "kinect/milk.pcd").size(), 13704U);
}

}  // namespace
}  // namespace ostraka
