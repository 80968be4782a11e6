// SPDX-License-Identifier: Apache-2.0
// Helpers of the io tests: bytes from text, a folder for a test's files, and hostile variants of
// files.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <string>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka::io_testing {

inline std::span<const char> bytes_of(const std::string& text) {
    return {text.data(), text.size()};
}

/// Appends `value` in byte order `order`.
template <class T>
void put(std::string& bytes, T value, std::endian order = std::endian::little) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (order != std::endian::native) {
        std::reverse(raw.begin(), raw.end());
    }
    bytes.append(raw.data(), raw.size());
}

/// A folder of the running test, empty at first and removed at its end.
class TestFolder {
  public:
    TestFolder() {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        path_ = std::filesystem::temp_directory_path() /
                fmt::format("ostraka_{}_{}", test->test_suite_name(), test->name());
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~TestFolder() { std::filesystem::remove_all(path_); }
    TestFolder(const TestFolder&) = delete;
    TestFolder& operator=(const TestFolder&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

inline void save(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream file(path, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline std::string load_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline void expect_well_formed(const TriangleMesh& mesh) {
    for (const Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t vertex : triangle) {
            ASSERT_LT(vertex, mesh.vertices.size());
        }
    }
}

inline void expect_well_formed(const PointCloud& cloud) {
    EXPECT_NO_THROW(check(cloud));
}

/// Parses; a FormatError is fine, another exception or a malformed result is a failure.
/// @return whether it parsed.
template <class Parse>
bool survives(const Parse& parse, const std::string& bytes) {
    try {
        expect_well_formed(parse(bytes));
        return true;
    } catch (const FormatError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
    return false;
}

/// Every prefix of a valid file, then single bytes changed at random places.
/// @return how many of the prefixes, the whole not counted, were accepted.
template <class Parse>
int expect_survives_damage(const Parse& parse, const std::string& valid, int changes = 3000) {
    EXPECT_TRUE(survives(parse, valid));
    int accepted = 0;
    for (std::size_t length = 0; length < valid.size(); ++length) {
        accepted += survives(parse, valid.substr(0, length)) ? 1 : 0;
    }
    std::uint64_t state = 1;
    for (int i = 0; i < changes; ++i) {
        std::string damaged = valid;
        for (int k = 0; k <= i % 3; ++k) {
            state = state * 6364136223846793005ULL + 1442695040888963407ULL;
            damaged[(state >> 33U) % damaged.size()] = static_cast<char>(state >> 20U);
        }
        survives(parse, damaged);
    }
    return accepted;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t place = text.find(from);
    EXPECT_NE(place, std::string::npos) << from;
    return place == std::string::npos ? text : text.replace(place, from.size(), to);
}

/// The message of the FormatError that parsing `bytes` throws; "" if it throws none.
template <class Parse>
std::string problem_of(const Parse& parse, const std::string& bytes) {
    try {
        parse(bytes);
    } catch (const FormatError& error) {
        return error.what();
    }
    return "";
}

/// Equal, with NaN equal to NaN.
inline bool same(const Vec3f& a, const Vec3f& b) {
    for (int i = 0; i < 3; ++i) {
        if (!(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i])))) {
            return false;
        }
    }
    return true;
}

inline void expect_same(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_TRUE(same(a[i], b[i]))
            << i << ": " << a[i].transpose() << " and " << b[i].transpose();
    }
}

/// A tetrahedron with coordinates that have no short decimal form.
inline TriangleMesh make_mesh() {
    TriangleMesh mesh;
    mesh.vertices = {Vec3f(0.1F, -1e-20F, 1.0F / 3), Vec3f(1, 0, 0), Vec3f(0, 16777217.0F, 0),
                     Vec3f(0, 0, -3.4e38F)};
    mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    return mesh;
}

/// An organized 3 x 2 cloud with normals, colors, a hole and a viewpoint.
inline PointCloud make_cloud() {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    PointCloud cloud;
    cloud.points = {Vec3f(0.1F, 0.2F, 0.3F), Vec3f(nan, nan, nan), Vec3f(1, 2, 3),
                    Vec3f(-1, 1e-30F, 5),    Vec3f(4, 5, 6),       Vec3f(7, 8, 1.0F / 3)};
    cloud.normals = {Vec3f(0, 0, 1), Vec3f(nan, nan, nan), Vec3f(0, 1, 0),
                     Vec3f(1, 0, 0), Vec3f(0, -1, 0),      Vec3f(0.6F, 0.8F, 0)};
    cloud.colors = {{0, 1, 2},   {255, 254, 253}, {10, 20, 30},
                    {255, 0, 0}, {0, 255, 0},     {0, 0, 255}};
    cloud.width = 3;
    cloud.height = 2;
    cloud.viewpoint = Vec3f(0.5F, -2, 1.0F / 7);
    return cloud;
}

inline void expect_same(const PointCloud& a, const PointCloud& b) {
    expect_same(a.points, b.points);
    expect_same(a.normals, b.normals);
    EXPECT_EQ(a.colors, b.colors);
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_TRUE(same(a.viewpoint, b.viewpoint));
}

}  // namespace ostraka::io_testing
