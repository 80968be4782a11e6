// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/pcd.hpp"

#include "io/io_testing.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

PointCloud parse(const std::string& bytes) {
    return parse_pcd(bytes_of(bytes), "c.pcd").cloud;
}

std::string header(const std::string& data) {
    return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
           "FIELDS x y z pad rgb normal_x normal_y normal_z\nSIZE 4 8 2 1 4 4 4 4\n"
           "TYPE F F I U U F F F\nCOUNT 1 1 1 3 1 1 1 1\nWIDTH 2\nHEIGHT 2\n"
           "VIEWPOINT 1 2 3 1 0 0 0\nPOINTS 4\nDATA " +
           data + "\n";
}

const std::string kAscii = header("ascii") +
                           "0.5 1 -2 7 7 7 16711680 0 0 1\n1.5 1 -2 7 7 7 65280 0 0 1\n"
                           "nan nan 0 7 7 7 255 nan nan nan\n3.5 1 -2 7 7 7 4278255360 0 1 0\n";

constexpr std::array<std::uint32_t, 4> kColors = {0xff0000U, 0xff00U, 0xffU, 0xff00ff00U};

// The fields of point i, one string each.
std::array<std::string, 6> make_fields(int i) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const bool hole = i == 2;
    std::array<std::string, 6> fields;
    put(fields[0], hole ? nan : 0.5F + static_cast<float>(i));
    put(fields[1], hole ? static_cast<double>(nan) : 1.0);
    put(fields[2], static_cast<std::int16_t>(hole ? 0 : -2));
    fields[3] = "abc";
    put(fields[4], kColors[static_cast<std::size_t>(i)]);
    for (const float n : {0.0F, i == 3 ? 1.0F : 0.0F, i == 3 ? 0.0F : 1.0F}) {
        put(fields[5], hole ? nan : n);
    }
    return fields;
}

std::string make_binary() {
    std::string bytes = header("binary");
    for (int i = 0; i < 4; ++i) {
        for (const std::string& field : make_fields(i)) {
            bytes += field;
        }
    }
    return bytes;
}

// Field by field, as LZF literals; the four equal values of the padding as one repetition.
std::string make_compressed() {
    std::string lzf;
    std::size_t full = 0;
    const auto literal = [&](const std::string& bytes) {
        lzf += static_cast<char>(bytes.size() - 1);
        lzf += bytes;
        full += bytes.size();
    };
    for (std::size_t f = 0; f < 5; ++f) {
        if (f == 3) {
            literal("abc");
            lzf += static_cast<char>(7U << 5U);  // 9 bytes, from 3 back
            lzf += '\0';
            lzf += static_cast<char>(2);
            full += 9;
            continue;
        }
        for (int i = 0; i < 4; ++i) {
            literal(make_fields(i)[f]);
        }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (int i = 0; i < 4; ++i) {
            literal(make_fields(i)[5].substr(4 * axis, 4));
        }
    }
    std::string bytes = header("binary_compressed");
    put(bytes, static_cast<std::uint32_t>(lzf.size()));
    put(bytes, static_cast<std::uint32_t>(full));
    return bytes + lzf;
}

void expect_the_cloud(const CloudFile& file) {
    const PointCloud& cloud = file.cloud;
    EXPECT_TRUE(file.has_viewpoint);
    EXPECT_EQ(cloud.viewpoint, Vec3f(1, 2, 3));
    ASSERT_EQ(cloud.size(), 4U);
    EXPECT_EQ(cloud.width, 2);
    EXPECT_EQ(cloud.height, 2);
    EXPECT_EQ(cloud.points[1], Vec3f(1.5F, 1, -2));
    EXPECT_TRUE(std::isnan(cloud.points[2].y()));
    EXPECT_EQ(cloud.normals[3], Vec3f(0, 1, 0));
    const std::vector<Color> colors = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {0, 255, 0}};
    EXPECT_EQ(cloud.colors, colors);
}

TEST(Pcd, ReadsAscii) {
    expect_the_cloud(parse_pcd(bytes_of(kAscii), "c.pcd"));
}

TEST(Pcd, ReadsBinary) {
    expect_the_cloud(parse_pcd(bytes_of(make_binary()), "c.pcd"));
}

TEST(Pcd, ReadsBinaryCompressed) {
    expect_the_cloud(parse_pcd(bytes_of(make_compressed()), "c.pcd"));
}

TEST(Pcd, ReadsColorsPackedAsFloats) {
    // PCL prints the float whose bits are 0x00ff8040; an opaque rgba has the bits of a NaN in
    // binary.
    std::string text =
        "VERSION .5\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 1\nHEIGHT "
        "1\n"
        "POINTS 1\nDATA ascii\n1 2 3 2.3464059e-38\n";
    EXPECT_EQ(parse(text).colors[0], (Color{255, 128, 64}));
    text = replaced(text, "ascii\n1 2 3 2.3464059e-38\n", "binary\n");
    for (const std::uint32_t bits : {0U, 0U, 0U, 0xff010203U}) {
        put(text, bits);
    }
    EXPECT_EQ(parse(text).colors[0], (Color{1, 2, 3}));
}

TEST(Pcd, CloudSurvivesWritingAndReading) {
    PointCloud cloud = make_cloud();
    expect_same(parse(encode_pcd(cloud)), cloud);
    EXPECT_TRUE(parse_pcd(bytes_of(encode_pcd(cloud)), "c.pcd").has_viewpoint);
    cloud.colors.clear();
    cloud.width = cloud.height = 0;
    cloud.viewpoint.setZero();
    expect_same(parse(encode_pcd(cloud)), cloud);
    EXPECT_FALSE(parse_pcd(bytes_of(encode_pcd(cloud)), "c.pcd").has_viewpoint);
    cloud = {};
    expect_same(parse(encode_pcd(cloud)), cloud);
}

TEST(Pcd, EveryTruncatedBinaryIsRejected) {
    EXPECT_EQ(expect_survives_damage(parse, make_binary()), 0);
    EXPECT_EQ(expect_survives_damage(parse, make_compressed()), 0);
    EXPECT_EQ(expect_survives_damage(parse, encode_pcd(make_cloud())), 0);
}

TEST(Pcd, TruncatedAsciiIsRejectedUnlessOnlyItsLastEndIsMissing) {
    EXPECT_EQ(expect_survives_damage(parse, kAscii), 1);
}

TEST(Pcd, RejectsImpossibleHeaders) {
    for (const std::string& valid : {kAscii, make_binary(), make_compressed()}) {
        for (const std::string count :
             {"4294967295", "4294967294", "1000000000000000000", "-1", "x"}) {
            EXPECT_NE(problem_of(parse, replaced(valid, "POINTS 4", "POINTS " + count)), "");
            EXPECT_NE(problem_of(parse, replaced(valid, "WIDTH 2", "WIDTH " + count)), "");
            EXPECT_NE(problem_of(parse, replaced(valid, "POINTS 4",
                                                 "POINTS " + count +
                                                     "\nHEIGHT 1"
                                                     "\nWIDTH " +
                                                     count)),
                      "")
                << count;
            EXPECT_NE(problem_of(parse, replaced(valid, "COUNT 1 1", "COUNT 1 " + count)), "");
            EXPECT_NE(problem_of(parse, replaced(valid, "SIZE 4 8", "SIZE 4 " + count)), "");
        }
        EXPECT_NE(problem_of(parse, replaced(valid, "COUNT 1 1 1 3 1", "COUNT 1 1 0 3 1")), "");
        EXPECT_NE(problem_of(parse, replaced(valid, "TYPE F F", "TYPE F Q")), "");
        EXPECT_NE(problem_of(parse, replaced(valid, "DATA ", "DATA zip ")), "");
        EXPECT_NE(problem_of(parse, replaced(valid, "FIELDS x y z", "FIELDS x y w")), "");
    }
}

TEST(Pcd, NamesFilePlaceAndProblem) {
    EXPECT_EQ(problem_of(parse, replaced(kAscii, "1.5 1 -2", "1.5 one -2")),
              "c.pcd: line 13: \"one\" is not a number");
    const std::string binary = make_binary();
    EXPECT_EQ(
        problem_of(parse, binary.substr(0, binary.size() - 1)),
        fmt::format("c.pcd: byte {}: file ends after 3 of 4 points", header("binary").size()));
}

TEST(Pcd, RejectsDamagedCompression) {
    const std::string valid = make_compressed();
    const std::size_t start = header("binary_compressed").size();
    for (const std::uint32_t size : {0xffffffffU, 0U, 1U}) {
        std::string sized;
        put(sized, size);
        EXPECT_NE(problem_of(parse, std::string(valid).replace(start, 4, sized)), "");
        EXPECT_NE(problem_of(parse, std::string(valid).replace(start + 4, 4, sized)), "");
    }
    // A repetition that reaches back before the start.
    EXPECT_NE(problem_of(parse, std::string(valid).replace(start + 8, 2, "\x3f\xff")), "");
}

}  // namespace
}  // namespace ostraka
