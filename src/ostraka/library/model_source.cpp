// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/model_source.hpp"

#include "ostraka/base/error.hpp"
#include "ostraka/base/sha256.hpp"
#include "ostraka/io/mesh_file.hpp"
#include "ostraka/mesh/repair.hpp"

namespace ostraka {

ModelSource load_model(const std::filesystem::path& path) {
    const TriangleMesh mesh = read_mesh(path);
    ModelSource source{.name = path.stem().string(),
                       .mesh = {},
                       .file = path.filename().string(),
                       .sha256 = sha256_of_file(path)};
    try {
        source.mesh = repair(mesh).mesh;
    } catch (const InvalidInput& error) {
        throw InvalidInput(path.string() + ": " + error.what());
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
