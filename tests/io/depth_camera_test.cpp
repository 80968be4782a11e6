// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/depth_camera.hpp"

#include "io/io_testing.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

TEST(DepthCamera, SurvivesWritingAndReading) {
    const TestFolder folder;
    const DepthCamera camera{{640, 480, 575.0 / 3.0, 574.5, 319.25, 239.0}, 0.125, Unit::inch};
    write_camera_json(folder / "camera.json", camera);
    const DepthCamera read = read_camera_json(folder / "camera.json");
    EXPECT_EQ(read.camera.width, 640);
    EXPECT_EQ(read.camera.height, 480);
    EXPECT_EQ(read.camera.fx, camera.camera.fx);
    EXPECT_EQ(read.camera.cy, camera.camera.cy);
    EXPECT_EQ(read.depth_scale, 0.125);
    EXPECT_EQ(read.unit, Unit::inch);
    const std::string valid = load_text(folder / "camera.json");
    for (std::size_t length = 0; length + 2 < valid.size(); ++length) {
        save(folder / "cut.json", valid.substr(0, length));
        EXPECT_THROW(read_camera_json(folder / "cut.json"), FormatError);
    }
    for (const auto& [from, to] : std::vector<std::array<std::string, 2>>{{"640", "0"},
                                                                          {"640", "6.5"},
                                                                          {"640", "100000000"},
                                                                          {"574.5", "-1"},
                                                                          {"574.5", "0"},
                                                                          {"0.125", "0"},
                                                                          {"\"in\"", "\"mile\""},
                                                                          {"\"cy\"", "\"cz\""}}) {
        save(folder / "bad.json", replaced(valid, from, to));
        EXPECT_THROW(read_camera_json(folder / "bad.json"), FormatError) << to;
    }
    EXPECT_THROW(write_camera_json(folder / "c.json", {{0, 480, 1.0, 1.0, 0.0, 0.0}, 1.0, {}}),
                 InvalidInput);
    EXPECT_THROW(depth_cloud({2, 1, {1, 2}}, {{3, 1, 1.0, 1.0, 0.0, 0.0}, 1.0, {}}), InvalidInput);
    EXPECT_EQ(depth_cloud({2, 1, {1, 2}}, {{0, 0, 1.0, 1.0, 0.0, 0.0}, 1.0, {}}).width, 2);
}

}  // namespace
}  // namespace ostraka
