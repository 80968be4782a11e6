// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/stl.hpp"

#include "io/io_testing.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

TriangleMesh parse(const std::string& bytes) {
    return parse_stl(bytes_of(bytes), "part.stl");
}

const std::string kAscii =
    "solid a facet of life\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n"
    "   vertex 0 1.5e0 0\n  endloop\n endfacet\n"
    " FACET NORMAL 0 0 1\n  OUTER LOOP\n   VERTEX 0 0 0\n   VERTEX 1 0 0\n"
    "   VERTEX 0 1 0\n  ENDLOOP\n ENDFACET\nendsolid\n";

TEST(Stl, ReadsAscii) {
    const TriangleMesh mesh = parse(kAscii);
    ASSERT_EQ(mesh.vertices.size(), 6U);
    EXPECT_EQ(mesh.vertices[2], Vec3f(0, 1.5F, 0));
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}}));
}

// Corners of the mesh in the order of its triangles: what an STL can hold.
std::vector<Vec3f> corners(const TriangleMesh& mesh) {
    std::vector<Vec3f> all;
    for (const Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t vertex : triangle) {
            all.push_back(mesh.vertices[vertex]);
        }
    }
    return all;
}

TEST(Stl, MeshSurvivesWritingAndReading) {
    const TriangleMesh mesh = make_mesh();
    const std::string bytes = encode_stl(mesh);
    EXPECT_EQ(bytes.size(), 84U + 4 * 50);
    EXPECT_EQ(parse(bytes).vertices, corners(mesh));
    EXPECT_EQ(corners(parse(bytes)), corners(mesh));
    EXPECT_TRUE(parse(encode_stl({})).triangles.empty());
}

TEST(Stl, ReadsBinaryThatBeginsWithSolid) {
    const std::string bytes = encode_stl(make_mesh()).replace(0, 6, "solid ");
    EXPECT_EQ(parse(bytes).vertices, corners(make_mesh()));
    EXPECT_EQ(parse(bytes + "pad").vertices, corners(make_mesh()));
}

TEST(Stl, NamesFilePlaceAndProblem) {
    const std::string bytes = encode_stl(make_mesh());
    EXPECT_EQ(problem_of(parse, bytes.substr(0, bytes.size() - 1)),
              "part.stl: byte 84: file ends after 3 of 4 triangles");
    EXPECT_EQ(problem_of(parse, replaced(kAscii, "vertex 1 0 0", "vertex 1 zero 0")),
              "part.stl: line 5: \"zero\" is not a number");
    EXPECT_EQ(problem_of(parse, kAscii.substr(0, kAscii.find("endsolid"))),
              "part.stl: line 15: file ends after 2 triangles without \"endsolid\"");
    EXPECT_EQ(problem_of(parse, ""),
              "part.stl: byte 0: file ends inside the header of a binary STL");
}

TEST(Stl, EveryTruncatedFileIsRejected) {
    EXPECT_EQ(expect_survives_damage(parse, encode_stl(make_mesh())), 0);
    // Without its last line's end an ASCII file is still whole.
    EXPECT_EQ(expect_survives_damage(parse, kAscii), 1);
}

TEST(Stl, RejectsImpossibleCounts) {
    for (const std::uint32_t count : {0xffffffffU, 0x80000000U, 5U}) {
        std::string number;
        put(number, count);
        EXPECT_NE(problem_of(parse, encode_stl(make_mesh()).replace(80, 4, number)), "");
    }
}

}  // namespace
}  // namespace ostraka
