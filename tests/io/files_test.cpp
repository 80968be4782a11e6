// SPDX-License-Identifier: Apache-2.0
// Choosing a format by extension, and files that can't be read at all.
#include <sys/stat.h>

#include <clocale>

#include "io/io_testing.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/io/cloud_file.hpp"
#include "ostraka/io/mesh_file.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

template <class Read>
std::string message_of(const Read& read) {
    try {
        read();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(Files, ExtensionNamesTheFormatInAnyCase) {
    const TestFolder folder;
    for (const std::string name : {"a.ply", "a.PLY", "a.Stl", "a.obj", "a.OFF"}) {
        write_mesh(folder / name, make_mesh());
        EXPECT_NEAR(surface_area(read_mesh(folder / name)) / surface_area(make_mesh()), 1.0, 1e-12)
            << name;
    }
    for (const std::string name : {"c.ply", "c.PCD", "c.xyz", "c.Txt", "c.asc"}) {
        write_cloud(folder / name, make_cloud());
        expect_same(read_cloud(folder / name).points, make_cloud().points);
    }
    EXPECT_TRUE(read_cloud_file(folder / "c.PCD").has_viewpoint);
    EXPECT_FALSE(read_cloud_file(folder / "c.xyz").has_viewpoint);
}

TEST(Files, UnknownExtensionsNameTheKnownOnes) {
    EXPECT_EQ(message_of([] { read_mesh("a.docx"); }),
              "a.docx: not a mesh format that can be read (.ply .obj .stl .off .gltf .glb)");
    EXPECT_EQ(message_of([] { write_mesh("a.gltf", {}); }),
              "a.gltf: not a mesh format that can be written (.ply .obj .stl .off)");
    EXPECT_EQ(message_of([] { read_cloud("a"); }),
              "a: not a known cloud format (.ply .pcd .xyz .txt .asc)");
    EXPECT_THROW(write_cloud("a.stl", {}), InvalidInput);
}

TEST(Files, WritersRejectBrokenInputAndLeaveNoFile) {
    const TestFolder folder;
    TriangleMesh mesh = make_mesh();
    mesh.triangles[2][1] = 4;
    EXPECT_THROW(write_mesh(folder / "a.stl", mesh), InvalidInput);
    PointCloud cloud = make_cloud();
    cloud.normals.pop_back();
    EXPECT_THROW(write_cloud(folder / "a.pcd", cloud), InvalidInput);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Files, EveryReaderSaysWhatIsWrongWithTheFileItself) {
    const TestFolder folder;
    const auto check_reader = [&](const std::string& name, const auto& read) {
        const std::filesystem::path path = folder / name;
        EXPECT_EQ(message_of([&] { read(path); }),
                  path.string() + ": can't be opened: No such file or directory");
        save(path, "");
        EXPECT_THROW(read(path), FormatError) << name;
        std::filesystem::remove(path);
        std::filesystem::create_directory(path);
        EXPECT_EQ(message_of([&] { read(path); }), path.string() + ": is a folder");
        std::filesystem::remove(path);
        ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
        EXPECT_EQ(message_of([&] { read(path); }), path.string() + ": is not a regular file");
        std::filesystem::remove(path);
    };
    for (const char* name : {"a.ply", "a.stl", "a.obj", "a.off", "a.gltf", "a.glb"}) {
        check_reader(name, [](const auto& path) { read_mesh(path); });
    }
    for (const char* name : {"a.ply", "a.pcd", "a.xyz"}) {
        check_reader(name, [](const auto& path) { read_cloud(path); });
    }
}

TEST(Files, NumbersDoNotDependOnTheLocale) {
    const TestFolder folder;
    const std::string old = std::setlocale(LC_ALL, nullptr);
    bool found = false;
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"}) {
        found = found || std::setlocale(LC_ALL, name) != nullptr;
    }
    write_mesh(folder / "a.obj", make_mesh());
    const TriangleMesh mesh = read_mesh(folder / "a.obj");
    std::setlocale(LC_ALL, old.c_str());
    EXPECT_EQ(mesh.vertices, make_mesh().vertices);
    if (!found) {
        GTEST_SKIP()
            << "no locale with a decimal comma is installed; tried in the present one only";
    }
}

}  // namespace
}  // namespace ostraka
