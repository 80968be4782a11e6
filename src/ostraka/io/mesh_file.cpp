// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/mesh_file.hpp"

#include <fmt/format.h>

#include "ostraka/base/error.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/gltf.hpp"
#include "ostraka/io/obj.hpp"
#include "ostraka/io/off.hpp"
#include "ostraka/io/ply.hpp"
#include "ostraka/io/stl.hpp"

namespace ostraka {
namespace {

struct MeshFormat {
    const char* extension;
    TriangleMesh (*parse)(std::span<const char>, const std::filesystem::path&);
    std::string (*encode)(const TriangleMesh&);
};

constexpr MeshFormat kFormats[] = {
    {".ply", parse_ply_mesh, encode_ply},
    {".obj", parse_obj, encode_obj},
    {".stl", parse_stl, encode_stl},
    {".off", parse_off, encode_off},
};

const MeshFormat* find_format(const std::string& extension) {
    for (const MeshFormat& format : kFormats) {
        if (extension == format.extension) {
            return &format;
        }
    }
    return nullptr;
}

void check_before_writing(const TriangleMesh& mesh) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (const std::uint32_t vertex : mesh.triangles[i]) {
            if (vertex >= mesh.vertices.size()) {
                throw InvalidInput(fmt::format("mesh triangle {} names vertex {} of {}", i, vertex,
                                               mesh.vertices.size()));
            }
        }
    }
}

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& path) {
    const std::string extension = lower_extension(path);
    if (extension == ".gltf" || extension == ".glb") {
        return read_gltf(path);
    }
    const MeshFormat* format = find_format(extension);
    if (format == nullptr) {
        throw InvalidInput(
            fmt::format("{}: not a mesh format that can be read (.ply .obj .stl .off "
                        ".gltf .glb)",
                        path.string()));
    }
    return format->parse(read_file(path).span(), path);
}

void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
    const MeshFormat* format = find_format(lower_extension(path));
    if (format == nullptr) {
        throw InvalidInput(fmt::format(
            "{}: not a mesh format that can be written (.ply .obj .stl .off)", path.string()));
    }
    check_before_writing(mesh);
    write_file_atomically(path, format->encode(mesh));
}

}  // namespace ostraka
