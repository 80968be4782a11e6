// SPDX-License-Identifier: Apache-2.0
// The clouds that benchmarks run on: views as a library holds them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"

namespace ostraka::bench {

struct BenchCloud {
    std::string name;
    PointCloud cloud;                ///< model frame, with normals and a viewpoint
    double mr = 0.0;                 ///< mean distance to the nearest neighbor, the cloud's unit
    double radius = 0.0;             ///< largest distance to the centroid
    std::vector<Vec3f> keypoints;    ///< 200 points of the cloud, evenly by index
    std::vector<PointCloud> pieces;  ///< of a batch: then all else is empty
};

/// A view of a mesh file, sampled so that it holds about `points` points.
BenchCloud view_of(const std::string& name, const std::filesystem::path& mesh, std::size_t points);

/// 200 smaller views of one mesh: a batch for several threads.
BenchCloud batch_of(const std::string& name, const std::filesystem::path& mesh);

/// Where the shipped parts lie. @throws FileError if that is not found from the working directory.
std::filesystem::path shipped_parts();

}  // namespace ostraka::bench
