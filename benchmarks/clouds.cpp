// SPDX-License-Identifier: Apache-2.0
#include "clouds.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/io/mesh_file.hpp"
#include "ostraka/mesh/repair.hpp"
#include "ostraka/views/model_views.hpp"

namespace ostraka::bench {
namespace {

constexpr std::size_t kKeypoints = 200;
constexpr int kView = 5;  // one of 42 that shows much of every model used here
constexpr std::size_t kBatch = 200;

struct Model {
    explicit Model(const std::filesystem::path& path) : mesh(repair(read_mesh(path)).mesh) {}
    TriangleMesh mesh;
    MeshShape shape = measure(mesh);
    RayScene scene{{mesh}};
};

}  // namespace

BenchCloud view_of(const std::string& name, const std::filesystem::path& mesh, std::size_t points) {
    const Model model(mesh);
    ViewSettings settings;
    settings.sampling = 0.01 * model.shape.diameter;
    BenchCloud result;
    result.name = name;
    // The number of points goes with the inverse square of the sampling distance.
    for (int round = 0; round < 3; ++round) {
        result.cloud = make_view(model.scene, model.shape, settings, kView).cloud;
        const double ratio = static_cast<double>(result.cloud.size()) / static_cast<double>(points);
        settings.sampling *= std::sqrt(ratio);
    }
    result.mr = mesh_resolution(result.cloud.points);
    const Vec3d center = centroid(result.cloud.points);
    for (const Vec3f& point : result.cloud.points) {
        result.radius = std::max(result.radius, (point.cast<double>() - center).norm());
    }
    for (std::size_t k = 0; k < kKeypoints; ++k) {
        result.keypoints.push_back(result.cloud.points[k * result.cloud.size() / kKeypoints]);
    }
    return result;
}

BenchCloud batch_of(const std::string& name, const std::filesystem::path& mesh) {
    const Model model(mesh);
    ViewSettings settings;
    settings.count = 320;
    settings.sampling = 0.015 * model.shape.diameter;
    BenchCloud batch;
    batch.name = name;
    batch.pieces.resize(kBatch);
    parallel_for(kBatch, [&](std::size_t i) {
        batch.pieces[i] = make_view(model.scene, model.shape, settings, static_cast<int>(i)).cloud;
    });
    return batch;
}

std::filesystem::path shipped_parts() {
    const std::filesystem::path parts = "data/parts";
    if (!std::filesystem::is_directory(parts)) {
        throw FileError(parts, "not found: run from the folder that holds it");
    }
    return parts;
}

}  // namespace ostraka::bench
