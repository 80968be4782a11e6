// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/off.hpp"

#include "io/io_testing.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

TriangleMesh parse(const std::string& bytes) {
    return parse_off(bytes_of(bytes), "m.off");
}

const std::string kBody = "0 0 0\n1 0 0 # second\n\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n3 0 1 2\n";

TEST(Off, ReadsCountsOnEitherLine) {
    for (const std::string head : {"OFF\n4 2 0\n", "OFF 4 2 0\n", "OFF4 2 0\n",
                                   "# note\nOFF # a\n# b\n\n4 2 5\n", "OFF\r\n4 2\r\n"}) {
        const TriangleMesh mesh = parse(head + kBody);
        ASSERT_EQ(mesh.vertices.size(), 4U) << head;
        EXPECT_EQ(mesh.vertices[2], Vec3f(1, 1, 0));
        EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}));
    }
}

TEST(Off, SkipsColorsNormalsAndTextureColumns) {
    for (const std::string head : {"COFF", "NOFF", "CNOFF", "STOFF"}) {
        const TriangleMesh mesh =
            parse(head + "\n3 1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n");
        EXPECT_EQ(mesh.vertices[2], Vec3f(0, 1, 0));
        EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    }
}

TEST(Off, MeshSurvivesWritingAndReading) {
    const TriangleMesh mesh = make_mesh();
    const TriangleMesh read = parse(encode_off(mesh));
    EXPECT_EQ(read.vertices, mesh.vertices);
    EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST(Off, NamesFileLineAndProblem) {
    const std::string text = "OFF\n4 2 0\n" + kBody;
    EXPECT_EQ(problem_of(parse, replaced(text, "3 0 1 2", "3 0 1 4")),
              "m.off: line 9: names vertex \"4\", but there are 4");
    EXPECT_EQ(problem_of(parse, replaced(text, "3 0 1 2", "3 0 1")),
              "m.off: line 9: face 1 states \"3\" corners, the line has 2");
    EXPECT_EQ(problem_of(parse, "4OFF\n"),
              "m.off: line 1: not an OFF file in three dimensions: it begins with \"4OFF\"");
    EXPECT_EQ(problem_of(parse, ""), "m.off: line 0: not an OFF file: it is empty");
    EXPECT_NE(problem_of(parse, "OFF BINARY\n"), "");
    EXPECT_NE(problem_of(parse, replaced(text, "3 0 1 2", "3 0 1 -1")), "");
    EXPECT_NE(problem_of(parse, replaced(text, "3 0 1 2", "1000000000000000000 1 2")), "");
}

TEST(Off, RejectsImpossibleCounts) {
    for (const std::string count : {"4294967295", "1000000000000000000", "-1", "nan", "1e18"}) {
        EXPECT_NE(problem_of(parse, "OFF\n" + count + " 2 0\n" + kBody), "");
        EXPECT_NE(problem_of(parse, "OFF\n4 " + count + " 0\n" + kBody), "");
    }
}

TEST(Off, EveryTruncatedFileIsRejected) {
    EXPECT_EQ(expect_survives_damage(parse, "OFF\n4 2 0\n" + kBody), 1);
}

}  // namespace
}  // namespace ostraka
