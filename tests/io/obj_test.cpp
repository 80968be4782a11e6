// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/obj.hpp"

#include "io/io_testing.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

TriangleMesh parse(const std::string& bytes) {
    return parse_obj(bytes_of(bytes), "m.obj");
}

const std::string kText =
    "# cube's side\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0 # c\n"
    "vt 0 0\nvn 0 0 1\nusemtl x\ns off\n";

TEST(Obj, ReadsEveryWayToNameAVertex) {
    for (const std::string face :
         {"f 1 2 3 4", "f 1/1 2/1 3/1 4/1", "f 1//1 2//1 3//1 4//1", "f 1/1/1 2/1/1 3/1/1 4/1/1",
          "f -4 -3 -2 -1", "f 1 2 \\\n3 4", "f 1 2\\\r\n 3 4"}) {
        const TriangleMesh mesh = parse(kText + face + "\n");
        ASSERT_EQ(mesh.vertices.size(), 4U);
        EXPECT_EQ(mesh.vertices[2], Vec3f(1, 1, 0));
        EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}})) << face;
    }
}

TEST(Obj, CountsBackwardFromTheLatestVertex) {
    const TriangleMesh mesh = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -3 -2 -1\n");
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 2, 3}}));
}

TEST(Obj, MeshSurvivesWritingAndReading) {
    const TriangleMesh mesh = make_mesh();
    const TriangleMesh read = parse(encode_obj(mesh));
    EXPECT_EQ(read.vertices, mesh.vertices);
    EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST(Obj, NamesFileLineAndProblem) {
    EXPECT_EQ(problem_of(parse, kText + "f 1 2 5\n"),
              "m.obj: triangle 0: names vertex 4, but there are 4");
    EXPECT_EQ(problem_of(parse, kText + "f 1 2 -5\n"),
              "m.obj: line 12: \"-5\" names none of the 4 vertices so far");
    EXPECT_EQ(problem_of(parse, kText + "f 1 2 0\n"),
              "m.obj: line 12: \"0\" names no vertex (they count from 1)");
    EXPECT_EQ(problem_of(parse, "v 1 2\n"), "m.obj: line 1: \"\" is not a coordinate");
    EXPECT_EQ(problem_of(parse, ""), "m.obj: line 0: no vertex: not an OBJ file, or an empty one");
    EXPECT_NE(problem_of(parse, kText + "f 1 2 4294967296\n"), "");
    EXPECT_NE(problem_of(parse, kText + "f 1 2 -9223372036854775808\n"), "");
    EXPECT_NE(problem_of(parse, kText + "f 1 2 nan\n"), "");
}

TEST(Obj, SurvivesDamage) {
    expect_survives_damage(parse, kText + "f 1//1 2//1 3//1 4//1\nf 1 2 \\\n3");
}

}  // namespace
}  // namespace ostraka
