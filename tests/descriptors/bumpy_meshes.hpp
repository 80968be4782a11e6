// SPDX-License-Identifier: Apache-2.0
// Height fields on a nearly regular triangle grid, with exact normals.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "ostraka/base/random.hpp"
#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/triangulation.hpp"

namespace ostraka::shapes {

struct Mesh {
    PointCloud cloud;
    std::vector<IndexTriangle> triangles;
};

/// count x count points with edges of length 1 around the origin, in rows half a step apart, each
/// off its place by up to `jitter`; z from `height`.
inline Mesh height_field(int count, double jitter,
                         const std::function<double(double, double)>& height) {
    Mesh mesh;
    Random random(6);
    const double row = std::sqrt(0.75);
    for (int j = 0; j < count; ++j) {
        for (int i = 0; i < count; ++i) {
            const double x = i - 0.5 * count + 0.5 * (j % 2) + random.uniform(-jitter, jitter);
            const double y = (j - 0.5 * count) * row + random.uniform(-jitter, jitter);
            const double h = 1e-4;
            const Vec3d normal(-(height(x + h, y) - height(x - h, y)) / (2.0 * h),
                               -(height(x, y + h) - height(x, y - h)) / (2.0 * h), 1.0);
            mesh.cloud.points.push_back(Vec3d(x, y, height(x, y)).cast<float>());
            mesh.cloud.normals.push_back(normal.normalized().cast<float>());
        }
    }
    mesh.cloud.viewpoint = Vec3f(0.0F, 0.0F, 1000.0F);
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * count + i); };
    for (int j = 0; j + 1 < count; ++j) {
        for (int i = 0; i + 1 < count; ++i) {
            if (j % 2 == 0) {
                mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
                mesh.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
            } else {
                mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
                mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
            }
        }
    }
    return mesh;
}

inline double gaussian(double x, double y, double deviation) {
    return std::exp(-(x * x + y * y) / (2.0 * deviation * deviation));
}

/// Bumps and dents of several sizes, none of them round.
inline Mesh landscape(int count) {
    return height_field(count, 0.1, [](double x, double y) {
        return 3.0 * gaussian(x + 14.0, 1.3 * (y - 12.0), 2.5) -
               2.5 * gaussian(1.4 * (x - 13.0), y - 11.0, 2.0) +
               4.0 * gaussian(x - 12.0 + 0.5 * y, y + 13.0, 3.0) +
               2.0 * gaussian(x + 10.0, 1.5 * (y + 12.0) - 0.4 * x, 1.8) +
               1.5 * gaussian(x - 1.0, 1.6 * (y + 1.0), 2.2);
    });
}

inline Mesh moved(const Mesh& mesh, const Pose& T_b_a) {
    return {transformed(mesh.cloud, T_b_a), mesh.triangles};
}

inline Mesh scaled(const Mesh& mesh, double factor) {
    return {ostraka::scaled(mesh.cloud, factor), mesh.triangles};
}

}  // namespace ostraka::shapes
