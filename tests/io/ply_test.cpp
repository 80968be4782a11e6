// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/ply.hpp"

#include "io/io_testing.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

TriangleMesh parse_mesh(const std::string& bytes) {
    return parse_ply_mesh(bytes_of(bytes), "m.ply");
}
PointCloud parse_cloud(const std::string& bytes) {
    return parse_ply_cloud(bytes_of(bytes), "c.ply").cloud;
}

const std::string kAscii =
    "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\n"
    "property float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n4 0 1 2 3\n3 0 2 3\n";

TEST(Ply, ReadsAsciiPolygonsAsFans) {
    const TriangleMesh mesh = parse_mesh(kAscii);
    ASSERT_EQ(mesh.vertices.size(), 4U);
    EXPECT_EQ(mesh.vertices[3], Vec3f(0, 1, 0.5F));
    const std::vector<Triangle> expected = {{0, 1, 2}, {0, 2, 3}, {0, 2, 3}};
    EXPECT_EQ(mesh.triangles, expected);
}

TEST(Ply, ReadsWindowsLineEnds) {
    std::string text = kAscii;
    for (std::size_t i = 0; (i = text.find('\n', i)) != std::string::npos; i += 2) {
        text.replace(i, 1, "\r\n");
    }
    EXPECT_EQ(parse_mesh(text).triangles, parse_mesh(kAscii).triangles);
}

// Odd types and order, properties to skip, a list among the vertex's, an element to skip, faces
// first.
std::string make_binary(std::endian order) {
    std::string bytes = fmt::format(
        "ply\nformat {} 1.0\nelement face 1\nproperty uchar flags\n"
        "property list ushort uint vertex_index\nproperty list char double extra\n"
        "element tag 2\nproperty short a\n"
        "element vertex 3\nproperty uchar red\nproperty double z\nproperty list uchar short l\n"
        "property short x\nproperty uchar green\nproperty int y\nproperty uchar blue\n"
        "property float ny\nproperty float nx\nproperty float nz\nend_header\n",
        order == std::endian::big ? "binary_big_endian" : "binary_little_endian");
    put(bytes, std::uint8_t{9}, order);
    put(bytes, std::uint16_t{3}, order);
    for (const std::uint32_t index : {2U, 0U, 1U}) {
        put(bytes, index, order);
    }
    put(bytes, std::int8_t{1}, order);
    put(bytes, 3.0, order);
    put(bytes, std::int16_t{-1}, order);
    put(bytes, std::int16_t{-2}, order);
    for (int i = 0; i < 3; ++i) {
        put(bytes, static_cast<std::uint8_t>(200 + i), order);
        put(bytes, 0.25 * i, order);
        put(bytes, static_cast<std::uint8_t>(i), order);
        for (int k = 0; k < i; ++k) {
            put(bytes, std::int16_t{77}, order);
        }
        put(bytes, static_cast<std::int16_t>(-300 + i), order);
        put(bytes, std::uint8_t{7}, order);
        put(bytes, std::int32_t{70000}, order);
        put(bytes, std::uint8_t{8}, order);
        put(bytes, 1.0F, order);
        put(bytes, 0.5F, order);
        put(bytes, -1.0F, order);
    }
    return bytes;
}

TEST(Ply, ReadsAnyTypesAndOrderInBothByteOrders) {
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        const std::string bytes = make_binary(order);
        const TriangleMesh mesh = parse_mesh(bytes);
        EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{2, 0, 1}}));
        const PointCloud cloud = parse_cloud(bytes);
        ASSERT_EQ(cloud.size(), 3U);
        EXPECT_EQ(cloud.points[2], Vec3f(-298, 70000, 0.5F));
        EXPECT_EQ(cloud.normals[1], Vec3f(0.5F, 1, -1));
        EXPECT_EQ(cloud.colors[2], (Color{202, 7, 8}));
        EXPECT_EQ(mesh.vertices, cloud.points);
    }
}

TEST(Ply, ReadsFloatColorsAsFractions) {
    const std::string text =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\nproperty float red\nproperty float green\nproperty float blue\n"
        "end_header\nnan 1e-400 -1e400 1 0.5 -3\n";
    const PointCloud cloud = parse_cloud(text);
    EXPECT_EQ(cloud.colors[0], (Color{255, 128, 0}));
    EXPECT_TRUE(std::isnan(cloud.points[0].x()));
    EXPECT_EQ(cloud.points[0].y(), 0.0F);
    EXPECT_TRUE(std::isinf(cloud.points[0].z()));
}

TEST(Ply, SpreadsAStanfordRangeGrid) {
    const std::string text =
        "ply\nformat ascii 1.0\nobj_info num_cols 2\nobj_info num_rows 2\nelement vertex 2\n"
        "property float x\nproperty float y\nproperty float z\nelement range_grid 4\n"
        "property list uchar int vertex_indices\nend_header\n1 1 1\n2 2 2\n0\n1 1\n1 0\n0\n";
    const PointCloud cloud = parse_cloud(text);
    ASSERT_EQ(cloud.size(), 4U);
    EXPECT_EQ(cloud.width, 2);
    EXPECT_EQ(cloud.height, 2);
    EXPECT_TRUE(std::isnan(cloud.points[0].x()));
    EXPECT_EQ(cloud.points[1], Vec3f(2, 2, 2));
    EXPECT_EQ(cloud.points[2], Vec3f(1, 1, 1));
}

TEST(Ply, MeshSurvivesWritingAndReading) {
    const TriangleMesh mesh = make_mesh();
    const TriangleMesh read = parse_mesh(encode_ply(mesh));
    EXPECT_EQ(read.vertices, mesh.vertices);
    EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST(Ply, CloudSurvivesWritingAndReading) {
    PointCloud cloud = make_cloud();
    expect_same(parse_cloud(encode_ply(cloud)), cloud);
    EXPECT_TRUE(parse_ply_cloud(bytes_of(encode_ply(cloud)), "c.ply").has_viewpoint);
    cloud.normals.clear();
    cloud.width = cloud.height = 0;
    cloud.viewpoint.setZero();
    expect_same(parse_cloud(encode_ply(cloud)), cloud);
    EXPECT_FALSE(parse_ply_cloud(bytes_of(encode_ply(cloud)), "c.ply").has_viewpoint);
    cloud = {};
    expect_same(parse_cloud(encode_ply(cloud)), cloud);
}

TEST(Ply, EveryTruncatedBinaryIsRejected) {
    EXPECT_EQ(expect_survives_damage(parse_mesh, make_binary(std::endian::big)), 0);
    EXPECT_EQ(expect_survives_damage(parse_cloud, make_binary(std::endian::little)), 0);
    EXPECT_EQ(expect_survives_damage(parse_mesh, encode_ply(make_mesh())), 0);
    EXPECT_EQ(expect_survives_damage(parse_cloud, encode_ply(make_cloud())), 0);
}

TEST(Ply, TruncatedAsciiIsRejectedUnlessOnlyItsLastNumberIsHurt) {
    // "3 0 2 3" without its line's end is still whole.
    EXPECT_EQ(expect_survives_damage(parse_mesh, kAscii), 1);
}

TEST(Ply, RejectsImpossibleCountsBeforeAllocating) {
    for (const std::string count : {"4294967295", "1000000000000000000", "9223372036854775807",
                                    "18446744073709551615", "-1", "1e18", "nan", ""}) {
        EXPECT_NE(problem_of(parse_mesh, replaced(kAscii, "vertex 4", "vertex " + count)), "")
            << count;
        EXPECT_NE(problem_of(parse_mesh, replaced(kAscii, "face 2", "face " + count)), "") << count;
        const std::string binary = encode_ply(make_mesh());
        EXPECT_NE(problem_of(parse_mesh, replaced(binary, "vertex 4", "vertex " + count)), "")
            << count;
        EXPECT_NE(problem_of(parse_mesh, replaced(binary, "face 4", "face " + count)), "") << count;
    }
    EXPECT_NE(problem_of(parse_mesh, replaced(kAscii, "element face",
                                              "element a 1000000000000000000\n"
                                              "element face")),
              "");
}

TEST(Ply, NamesFileLineAndProblem) {
    EXPECT_EQ(problem_of(parse_mesh, replaced(kAscii, "3 0 2 3", "3 0 2 4")),
              "m.ply: line 16: names vertex 4, but there are 4");
    EXPECT_EQ(problem_of(parse_mesh, replaced(kAscii, "1 1 0", "1 one 0")),
              "m.ply: line 13: \"one\" is not a number");
    EXPECT_EQ(problem_of(parse_mesh, replaced(kAscii, "end_header", "end")),
              "m.ply: line 10: unknown header line \"end\"");
    EXPECT_EQ(problem_of(parse_mesh, ""),
              "m.ply: line 1: not a PLY file: it doesn't begin with \"ply\"");
}

TEST(Ply, RejectsBrokenLists) {
    for (const std::string face : {"3 0 2 -1", "4294967295 0 1 2", "-3 0 1 2", "3 0 1.5 2",
                                   "3 nan 0 1", "1000000000000000000 1 2"}) {
        EXPECT_NE(problem_of(parse_mesh, replaced(kAscii, "3 0 2 3", face)), "") << face;
    }
    EXPECT_NE(problem_of(parse_mesh, replaced(kAscii, "uchar int", "float int")), "");
    EXPECT_NE(problem_of(parse_mesh, replaced(kAscii, "property float z", "property float w")), "");
    EXPECT_NE(problem_of(parse_mesh, replaced(kAscii, "float z", "list uchar float z")), "");
    std::string binary = encode_ply(make_mesh());
    binary[binary.size() - 13] = '\xff';  // length of the last face
    EXPECT_NE(problem_of(parse_mesh, binary), "");
}

}  // namespace
}  // namespace ostraka
