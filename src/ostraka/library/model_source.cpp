// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/model_source.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "ostraka/base/error.hpp"
#include "ostraka/base/sha256.hpp"
#include "ostraka/io/cloud_file.hpp"
#include "ostraka/io/mesh_file.hpp"
#include "ostraka/mesh/cloud_surface.hpp"
#include "ostraka/mesh/repair.hpp"

namespace ostraka {
namespace {

std::string lower_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return extension;
}

bool holds_clouds_only(const std::string& extension) {
    constexpr std::array<std::string_view, 4> kExtensions = {".pcd", ".xyz", ".txt", ".asc"};
    return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

void rebuild(const PointCloud& cloud, ModelSource& source) {
    CloudSurface surface = rebuild_surface(cloud);
    source.mesh = std::move(surface.mesh);
    source.cloud_points = surface.points;
    source.cloud_spacing = surface.spacing;
}

}  // namespace

ModelSource load_model(const std::filesystem::path& path) {
    const std::string extension = lower_extension(path);
    ModelSource source{.name = path.stem().string(),
                       .mesh = {},
                       .file = path.filename().string(),
                       .sha256 = sha256_of_file(path)};
    TriangleMesh mesh;
    PointCloud cloud;
    if (holds_clouds_only(extension)) {
        cloud = read_cloud(path);
    } else {
        mesh = read_mesh(path);
        // Of the mesh formats only PLY has normals that the reader of clouds knows.
        if (mesh.triangles.empty() && extension == ".ply") cloud = read_cloud(path);
        if (mesh.triangles.empty() && extension != ".ply") cloud.points = mesh.vertices;
    }
    try {
        if (mesh.triangles.empty()) {
            rebuild(cloud, source);
        } else {
            source.mesh = repair(mesh).mesh;
        }
    } catch (const InvalidInput& error) {
        throw InvalidInput(path.string() + (mesh.triangles.empty() ? ": no faces; " : ": ") +
                           error.what());
    }
    return source;
}

ModelInput model_input(const std::filesystem::path& path) {
    return {.name = path.stem().string(),
            .file = path.filename().string(),
            .load = [path] { return load_model(path); },
            .sha256 = [path] { return sha256_of_file(path); }};
}

ModelInput model_input(const ModelSource& source) {
    return {.name = source.name,
            .file = source.file,
            .load = [&source] { return source; },
            .sha256 = [&source] { return source.sha256; }};
}

}  // namespace ostraka
