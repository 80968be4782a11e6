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

}  // namespace ostraka
