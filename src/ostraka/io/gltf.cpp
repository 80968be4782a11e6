// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/gltf.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/gltf_sanitize.hpp"

namespace ostraka {
namespace {

// Appends the triangles of `part`; points and lines are skipped.
void append_part(const aiMesh& part, const std::filesystem::path& path, TriangleMesh& mesh) {
    const std::size_t first = mesh.vertices.size();
    if (part.mNumVertices >= kNoIndex - first) {
        throw FormatError(path, "mesh", "too many vertices");
    }
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
        mesh.vertices.emplace_back(part.mVertices[i].x, part.mVertices[i].y, part.mVertices[i].z);
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
        const aiFace& face = part.mFaces[i];
        if (face.mNumIndices != 3) {
            continue;
        }
        Triangle triangle = {};
        for (std::size_t c = 0; c < 3; ++c) {
            triangle[c] = static_cast<std::uint32_t>(first) + face.mIndices[c];
        }
        mesh.triangles.push_back(triangle);
    }
}

TriangleMesh import(const std::string& glb, const std::filesystem::path& path) {
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFileFromMemory(
        glb.data(), glb.size(),
        aiProcess_ValidateDataStructure | aiProcess_Triangulate | aiProcess_PreTransformVertices,
        "glb");
    if (scene == nullptr) {
        std::string problem = importer.GetErrorString();
        std::replace(problem.begin(), problem.end(), '\n', ' ');
        throw FormatError(path, "mesh", problem);
    }
    TriangleMesh mesh;
    for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
        append_part(*scene->mMeshes[i], path, mesh);
    }
    check_indices(mesh, path);
    return mesh;
}

}  // namespace

TriangleMesh read_gltf(const std::filesystem::path& path) {
    const std::string glb = sanitize_gltf(read_file(path).span(), path);
    if (glb.empty()) {
        return {};
    }
    try {
        return import(glb, path);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw FormatError(path, "mesh", error.what());
    }
}

}  // namespace ostraka
