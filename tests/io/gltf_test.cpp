// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/gltf.hpp"

#include "io/io_testing.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

// Two triangles of a unit square: positions with a stride of 16, then 16-bit indices.
std::string make_buffer() {
    std::string buffer;
    const std::array<Vec3f, 4> corners = {Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(1, 1, 0),
                                          Vec3f(0, 1, 0)};
    for (const Vec3f& corner : corners) {
        for (const float coordinate : corner) {
            put(buffer, coordinate);
        }
        put(buffer, std::uint32_t{0xdeadbeef});
    }
    for (const std::uint16_t index : {0, 1, 2, 0, 2, 3}) {
        put(buffer, index);
    }
    return buffer;
}

std::string base64(const std::string& bytes) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            bits =
                bits << 8U | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63U] : '=';
        }
    }
    return text;
}

// The square twice: moved by (10, 0, 0), and below that turned by 90 degrees about z and doubled.
std::string make_json(const std::string& uri) {
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0, "translation": [10, 0, 0], "children": [1]},
 {"mesh": 0, "rotation": [0, 0, 0.70710678118654757, 0.70710678118654757], "scale": [2, 2, 2]},
 {"mesh": 0, "name": "not in the scene"}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1},
 {"attributes": {"POSITION": 0}, "mode": 0}]}],
"accessors": [
 {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
 {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteLength": 64, "byteStride": 16},
 {"buffer": 0, "byteOffset": 64, "byteLength": 12}],
"buffers": [{"byteLength": 76)" +
           (uri.empty() ? "" : ", \"uri\": \"" + uri + "\"") + "}]}";
}

std::string make_embedded() {
    return make_json("data:application/octet-stream;base64," + base64(make_buffer()));
}

std::string make_glb() {
    std::string json = make_json("");
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::string buffer = make_buffer();
    std::string bytes = "glTF";
    put(bytes, std::uint32_t{2});
    put(bytes, static_cast<std::uint32_t>(28 + json.size() + buffer.size()));
    put(bytes, static_cast<std::uint32_t>(json.size()));
    bytes += "JSON" + json;
    put(bytes, static_cast<std::uint32_t>(buffer.size()));
    bytes += std::string("BIN\0", 4) + buffer;
    return bytes;
}

void expect_the_mesh(const TriangleMesh& mesh) {
    ASSERT_EQ(mesh.triangles.size(), 4U);
    expect_well_formed(mesh);
    EXPECT_NEAR(surface_area(mesh), 1.0 + 4.0, 1e-6);
    Vec3f low = mesh.vertices[0];
    Vec3f high = low;
    for (const Vec3f& vertex : mesh.vertices) {
        low = low.cwiseMin(vertex);
        high = high.cwiseMax(vertex);
    }
    EXPECT_TRUE(low.isApprox(Vec3f(8, 0, 0), 1e-6F)) << low.transpose();
    EXPECT_TRUE(high.isApprox(Vec3f(11, 2, 0), 1e-6F)) << high.transpose();
    for (const Triangle& triangle : mesh.triangles) {
        EXPECT_GT(area_vector(mesh, triangle).z(), 0.0);
    }
}

TEST(Gltf, ReadsEmbeddedBuffersAndAppliesTransforms) {
    const TestFolder folder;
    save(folder / "a.gltf", make_embedded());
    expect_the_mesh(read_gltf(folder / "a.gltf"));
}

TEST(Gltf, ReadsGlb) {
    const TestFolder folder;
    save(folder / "a.glb", make_glb());
    expect_the_mesh(read_gltf(folder / "a.glb"));
}

TEST(Gltf, ReadsABufferBesideTheFile) {
    const TestFolder folder;
    save(folder / "a.gltf", make_json("my%20buffer.bin"));
    EXPECT_THROW(read_gltf(folder / "a.gltf"), FileError);
    save(folder / "my buffer.bin", make_buffer());
    expect_the_mesh(read_gltf(folder / "a.gltf"));
    save(folder / "my buffer.bin", make_buffer().substr(1));
    EXPECT_THROW(read_gltf(folder / "a.gltf"), FormatError);
}

class GltfDamage : public ::testing::Test {
  protected:
    TriangleMesh parse(const std::string& bytes) const {
        save(folder_ / "a.gltf", bytes);
        return read_gltf(folder_ / "a.gltf");
    }
    TestFolder folder_;
};

TEST_F(GltfDamage, EveryTruncatedFileIsRejected) {
    const auto read = [this](const std::string& bytes) { return parse(bytes); };
    EXPECT_EQ(expect_survives_damage(read, make_glb(), 200), 0);
    EXPECT_EQ(expect_survives_damage(read, make_embedded(), 200), 0);
}

TEST_F(GltfDamage, RejectsRangesThatDoNotFit) {
    const std::vector<std::array<std::string, 2>> changes = {
        {"\"count\": 4", "\"count\": 5"},
        {"\"count\": 4", "\"count\": 1000000000000000000"},
        {"\"count\": 4", "\"count\": -4"},
        {"\"count\": 4", "\"count\": 4.5"},
        {"\"count\": 4", "\"count\": 3"},  // the indices then name a vertex that isn't there
        {"\"count\": 6", "\"count\": 7"},
        {"5123", "5126"},
        {"5126", "5123"},
        {"VEC3", "VEC4"},
        {"\"byteStride\": 16", "\"byteStride\": 8"},
        {"\"byteStride\": 16", "\"byteStride\": 18446744073709551615"},
        {"\"byteOffset\": 64", "\"byteOffset\": 66"},
        {"\"byteOffset\": 64", "\"byteOffset\": 18446744073709551614"},
        {"\"byteLength\": 76", "\"byteLength\": 77"},
        {"\"byteLength\": 64", "\"byteLength\": 640"},
        {"\"bufferView\": 1", "\"bufferView\": 2"},
        {"\"buffer\": 0, \"byteO", "\"buffer\": 9, \"byteO"},
        {"\"indices\": 1", "\"indices\": 2"},
        {"\"POSITION\": 0", "\"POSITION\": 7"},
        {"\"mesh\": 0", "\"mesh\": 3"},
        {"\"children\": [1]", "\"children\": [0]"},
        {"\"children\": [1]", "\"children\": [1, 1]"},
        {"\"children\": [1]", "\"children\": [99]"},
        {"\"rotation\": [0, 0,", "\"children\": [1], \"rotation\": [0, 0,"},
        {"\"nodes\": [0]", "\"nodes\": [0, 0]"},
        {"\"nodes\": [0]", "\"nodes\": [-1]"},
        {"\"scene\": 0", "\"scene\": 4"},
        {"\"version\": \"2.0\"", "\"version\": \"1.0\""},
        {"\"scale\": [2, 2, 2]", "\"scale\": [2, 2, \"x\"]"},
    };
    for (const auto& [from, to] : changes) {
        EXPECT_THROW(parse(replaced(make_embedded(), from, to)), FormatError) << to;
    }
    EXPECT_THROW(parse(std::string(100'000, '[')), FormatError);
    EXPECT_THROW(parse(""), FormatError);
    EXPECT_THROW(parse("null"), FormatError);
    EXPECT_TRUE(parse(R"({"asset": {"version": "2.0"}})").triangles.empty());
}

}  // namespace
}  // namespace ostraka
