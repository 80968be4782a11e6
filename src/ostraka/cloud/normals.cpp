// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/normals.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/cell_grid.hpp"

namespace ostraka {
namespace {

// Below this ratio of the two larger deviations' variances the points lie on a line.
constexpr double kLineRatio = 1e-10;
constexpr double kLineRatioSingle = 1e-6;  // where the sums are in single precision
constexpr double kUnsureRatio = 1e-6;

const Vec3f kNone = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());

// Sums of a neighborhood's offsets from one of its points: enough for its plane.
struct Moments {
    Vec3d first = Vec3d::Zero();
    Mat3d second = Mat3d::Zero();
    double count = 0.0;
};

Vec3f fit_normal(const Moments& moments, double line_ratio) {
    if (moments.count < 3.0) return kNone;
    const Vec3d mean = moments.first / moments.count;
    const Mat3d scatter = moments.second / moments.count - mean * mean.transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(scatter);
    // The closed form loses half of the digits where two values are nearly equal, as on a line.
    if (solver.eigenvalues()[1] < kUnsureRatio * solver.eigenvalues()[2]) solver.compute(scatter);
    const Eigen::Vector3d values = solver.eigenvalues();
    if (!(values[2] > 0.0) || values[1] < line_ratio * values[2]) return kNone;
    return Vec3d(solver.eigenvectors().col(0)).normalized().cast<float>();
}

Vec3f fit_normal(std::span<const Vec3f> points, std::span<const Neighbor> neighbors) {
    if (neighbors.empty()) return kNone;
    const Vec3d origin = points[neighbors.front().index].cast<double>();
    Moments moments;
    for (const Neighbor& neighbor : neighbors) {
        const Vec3d offset = points[neighbor.index].cast<double>() - origin;
        moments.first += offset;
        moments.second += offset * offset.transpose();
    }
    moments.count = static_cast<double>(neighbors.size());
    return fit_normal(moments, kLineRatio);
}

// Offsets are short and many: single precision sums of ten products each lose nothing that matters.
Vec3f fit_normal_within(const Vec3f& query, std::span<const Vec3f> candidates,
                        float squared_radius) {
    std::array<float, 9> sums{};
    float count = 0.0F;
    for (const Vec3f& candidate : candidates) {
        const float x = candidate.x() - query.x();
        const float y = candidate.y() - query.y();
        const float z = candidate.z() - query.z();
        if (!(x * x + y * y + z * z < squared_radius)) continue;
        const std::array<float, 9> terms = {x, y, z, x * x, x * y, x * z, y * y, y * z, z * z};
        for (std::size_t k = 0; k < 9; ++k) sums[k] += terms[k];
        count += 1.0F;
    }
    Moments moments;
    moments.first = Vec3d(double{sums[0]}, double{sums[1]}, double{sums[2]});
    moments.second << double{sums[3]}, double{sums[4]}, double{sums[5]}, double{sums[4]},
        double{sums[6]}, double{sums[7]}, double{sums[5]}, double{sums[7]}, double{sums[8]};
    moments.count = double{count};
    return fit_normal(moments, kLineRatioSingle);
}

Vec3f toward(const Vec3f& normal, const Vec3f& from, const Vec3f& viewpoint) {
    return normal.dot(viewpoint - from) < 0.0F ? Vec3f(-normal) : normal;
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
            normals[i] =
                toward(fit_normal(cloud.points, neighbors), cloud.points[i], cloud.viewpoint);
        },
        256);
    return normals;
}

std::vector<Vec3f> estimate_normals(const PointCloud& cloud, const NormalSettings& settings) {
    return estimate_normals(cloud, KdTree(cloud.points), settings);
}

std::vector<Vec3f> estimate_normals_within(const PointCloud& cloud, double radius) {
    const CellGrid grid(cloud.points, radius);
    const auto squared_radius = static_cast<float>(radius * radius);
    std::vector<Vec3f> normals(cloud.size());
    parallel_for(
        grid.cell_count(),
        [&](std::size_t c) {
            thread_local std::vector<std::uint32_t> cells;
            thread_local std::vector<Vec3f> candidates;
            grid.neighborhood(c, cells);
            candidates.clear();
            for (const std::uint32_t cell : cells) {
                for (const std::uint32_t i : grid.members(cell)) {
                    candidates.push_back(cloud.points[i]);
                }
            }
            for (const std::uint32_t i : grid.members(c)) {
                const Vec3f& point = cloud.points[i];
                normals[i] = toward(fit_normal_within(point, candidates, squared_radius), point,
                                    cloud.viewpoint);
            }
        },
        64);
    return normals;
}

}  // namespace ostraka
