// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/xyz.hpp"

#include "io/io_testing.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

PointCloud parse(const std::string& bytes) {
    return parse_xyz(bytes_of(bytes), "c.xyz").cloud;
}

TEST(Xyz, ReadsBlanksCommasAndSemicolons) {
    const std::vector<Vec3f> expected = {Vec3f(1, -2, 0.5F), Vec3f(1e3F, 0, 4)};
    for (const std::string text :
         {"1 -2 .5\n1e3 0 4\n", "1,-2,.5\n1e3,0,4", "1 ; -2;\t.5\r\n1e3;0;4;\r\n",
          "# note\n\n 1\t-2 0.5 // here\n// there\n+1e3 0 4 # end\n", "x y z\n1 -2 .5\n1e3 0 4\n",
          "2\n1 -2 .5\n1e3 0 4\n", "1 -2 .5 9 9\n1e3 0 4 9 9\n"}) {
        const PointCloud cloud = parse(text);
        EXPECT_EQ(cloud.points, expected) << text;
        EXPECT_TRUE(cloud.normals.empty());
        EXPECT_TRUE(cloud.colors.empty());
    }
}

TEST(Xyz, KeepsPointsWithoutReturn) {
    const PointCloud cloud = parse("1 2 3\nnan NaN -nan\n");
    ASSERT_EQ(cloud.size(), 2U);
    EXPECT_TRUE(std::isnan(cloud.points[1].z()));
}

TEST(Xyz, TellsNormalsFromColors) {
    const PointCloud normals = parse("1 2 3 0 0 1\n1 2 3 1 0 0\n");
    EXPECT_EQ(normals.normals.size(), 2U);
    EXPECT_TRUE(normals.colors.empty());
    const PointCloud colors = parse("1 2 3 0 0 1\n1 2 3 255 0 0\n");
    EXPECT_TRUE(colors.normals.empty());
    EXPECT_EQ(colors.colors[1], (Color{255, 0, 0}));
    const PointCloud both = parse("1 2 3 9 8 7 0 0.6 0.8\n");
    EXPECT_EQ(both.colors[0], (Color{9, 8, 7}));
    EXPECT_EQ(both.normals[0], Vec3f(0, 0.6F, 0.8F));
}

TEST(Xyz, CloudSurvivesWritingAndReading) {
    PointCloud cloud = make_cloud();
    PointCloud expected = cloud;
    expected.width = expected.height = 0;
    expected.viewpoint.setZero();
    expect_same(parse(encode_xyz(cloud)), expected);
    cloud.colors.clear();
    expected.colors.clear();
    expect_same(parse(encode_xyz(cloud)), expected);
}

TEST(Xyz, NamesFileLineAndProblem) {
    EXPECT_EQ(problem_of(parse, "1 2 3\n1 2\n"), "c.xyz: line 2: 2 columns where 3 are expected");
    EXPECT_EQ(problem_of(parse, "1 2 3\n\n1 2 z\n"), "c.xyz: line 3: \"z\" is not a number");
    EXPECT_EQ(problem_of(parse, "1,,2,3\n"), "c.xyz: line 1: empty column");
    EXPECT_EQ(problem_of(parse, "1 2\n"), "c.xyz: line 1: 2 columns where at least 3 are expected");
    EXPECT_EQ(problem_of(parse, ""), "c.xyz: line 0: no points");
}

TEST(Xyz, SurvivesDamage) {
    expect_survives_damage(parse, encode_xyz(make_cloud()));
    expect_survives_damage(parse, "x,y,z\n# note\n1,2,3\n4,5,nan\n");
}

}  // namespace
}  // namespace ostraka
