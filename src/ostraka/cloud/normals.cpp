// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/normals.hpp"

#include <Eigen/Eigenvalues>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"

namespace ostraka {
namespace {

// Below this ratio of the two larger deviations' variances the points lie on a line.
constexpr double kLineRatio = 1e-10;
constexpr double kUnsureRatio = 1e-6;

Vec3f fit_normal(std::span<const Vec3f> points, std::span<const Neighbor> neighbors) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Vec3f none(nan, nan, nan);
    if (neighbors.size() < 3) return none;
    const Vec3d origin = points[neighbors.front().index].cast<double>();
    Vec3d mean = Vec3d::Zero();
    Mat3d scatter = Mat3d::Zero();
    for (const Neighbor& neighbor : neighbors) {
        const Vec3d offset = points[neighbor.index].cast<double>() - origin;
        mean += offset;
        scatter += offset * offset.transpose();
    }
    const auto count = static_cast<double>(neighbors.size());
    mean /= count;
    scatter = scatter / count - mean * mean.transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(scatter);
    // The closed form loses half of the digits where two values are nearly equal, as on a line.
    if (solver.eigenvalues()[1] < kUnsureRatio * solver.eigenvalues()[2]) solver.compute(scatter);
    const Eigen::Vector3d values = solver.eigenvalues();
    if (!(values[2] > 0.0) || values[1] < kLineRatio * values[2]) return none;
    return Vec3d(solver.eigenvectors().col(0)).normalized().cast<float>();
}

}  // namespace

std::vector<Vec3f> estimate_normals(const PointCloud& cloud, const KdTree& tree,
                                    const NormalSettings& settings) {
    if (settings.neighbors < 3) throw InvalidInput("normals: neighbors must be at least 3");
    std::vector<Vec3f> normals(cloud.size());
    parallel_for(
        cloud.size(),
        [&](std::size_t i) {
            thread_local std::vector<Neighbor> neighbors;
            tree.nearest(cloud.points[i], static_cast<std::size_t>(settings.neighbors), neighbors);
            Vec3f normal = fit_normal(cloud.points, neighbors);
            if (normal.dot(cloud.viewpoint - cloud.points[i]) < 0.0F) normal = -normal;
            normals[i] = normal;
        },
        256);
    return normals;
}

std::vector<Vec3f> estimate_normals(const PointCloud& cloud, const NormalSettings& settings) {
    return estimate_normals(cloud, KdTree(cloud.points), settings);
}

}  // namespace ostraka
