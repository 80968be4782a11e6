// SPDX-License-Identifier: Apache-2.0
// Guo et al. Rotational Projection Statistics for 3D Local Surface Description and Object
// Recognition. IJCV 105(1), 2013, section 3.1. With g the mean of a triangle's corners a_i and p
// the keypoint, the paper's double sum over the corners (eq. 3) is
//   sum_i sum_j (a_i - p)(a_j - p)^T + sum_i (a_i - p)(a_i - p)^T
//     = sum_i (a_i - g)(a_i - g)^T + 12 (g - p)(g - p)^T,
// of which the first part doesn't depend on the keypoint.
#include "ostraka/descriptors/rops_frame.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace ostraka {
namespace {

TriangleMoments moments_of(std::span<const Vec3f> points, const IndexTriangle& triangle) {
    const Vec3d a = points[triangle[0]].cast<double>();
    const Vec3d b = points[triangle[1]].cast<double>();
    const Vec3d c = points[triangle[2]].cast<double>();
    TriangleMoments m;
    m.center = (a + b + c) / 3.0;
    m.area = (b - a).cross(c - a).norm();
    m.spread = {};
    for (const Vec3d& corner : {a, b, c}) {
        const Vec3d d = corner - m.center;
        m.spread[0] += d.x() * d.x();
        m.spread[1] += d.x() * d.y();
        m.spread[2] += d.x() * d.z();
        m.spread[3] += d.y() * d.y();
        m.spread[4] += d.y() * d.z();
        m.spread[5] += d.z() * d.z();
    }
    return m;
}

// Weighted sums over triangles.
struct FrameSums {
    std::array<double, 6> scatter{};
    Vec3d side = Vec3d::Zero();  // where the surface lies, for the signs of the axes

    void add(const TriangleMoments& m, const Vec3d& keypoint, double radius) {
        const double x = m.center.x() - keypoint.x();
        const double y = m.center.y() - keypoint.y();
        const double z = m.center.z() - keypoint.z();
        const double nearness = radius - std::sqrt(x * x + y * y + z * z);
        const double weight = m.area * nearness * nearness;
        const double wx = 12.0 * weight * x;
        const double wy = 12.0 * weight * y;
        scatter[0] += weight * m.spread[0] + wx * x;
        scatter[1] += weight * m.spread[1] + wx * y;
        scatter[2] += weight * m.spread[2] + wx * z;
        scatter[3] += weight * m.spread[3] + wy * y;
        scatter[4] += weight * m.spread[4] + wy * z;
        scatter[5] += weight * m.spread[5] + 12.0 * weight * z * z;
        side += weight * Vec3d(x, y, z);
    }

    Mat3f frame() const {
        const double trace = scatter[0] + scatter[3] + scatter[5];
        if (!(trace > 0.0) || !std::isfinite(trace)) {
            return Mat3f::Constant(std::numeric_limits<float>::quiet_NaN());
        }
        Mat3d matrix;
        matrix << scatter[0], scatter[1], scatter[2], scatter[1], scatter[3], scatter[4],
            scatter[2], scatter[4], scatter[5];
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix / trace);
        Vec3d x = solver.eigenvectors().col(2);
        Vec3d z = solver.eigenvectors().col(0);
        if (side.dot(x) < 0.0) x = -x;
        if (side.dot(z) < 0.0) z = -z;
        Mat3d R_local_cloud;
        R_local_cloud.row(0) = x;
        R_local_cloud.row(1) = z.cross(x);
        R_local_cloud.row(2) = z;
        return R_local_cloud.cast<float>();
    }
};

}  // namespace

RopsSurface::RopsSurface(std::span<const Vec3f> points, std::span<const IndexTriangle> triangles) {
    moments_.reserve(triangles.size());
    starts_.assign(points.size() + 1, 0);
    for (const IndexTriangle& triangle : triangles) {
        moments_.push_back(moments_of(points, triangle));
        for (const std::uint32_t corner : triangle) ++starts_[corner + 1];
    }
    for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    triangles_.resize(3 * triangles.size());
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        for (const std::uint32_t corner : triangles[t]) triangles_[next[corner]++] = t;
    }
}

Mat3f RopsSurface::local_frame(const Vec3f& keypoint, float radius,
                               std::span<const Neighbor> neighbors, TriangleMarks& marks) const {
    const Vec3d center = keypoint.cast<double>();
    FrameSums sums;
    marks.start();
    for (const Neighbor& neighbor : neighbors) {
        for (std::uint32_t k = starts_[neighbor.index]; k < starts_[neighbor.index + 1]; ++k) {
            if (marks.first_time(triangles_[k])) sums.add(moments_[triangles_[k]], center, radius);
        }
    }
    return sums.frame();
}

Mat3f whole_frame(std::span<const Vec3f> points, std::span<const IndexTriangle> triangles,
                  const Vec3f& center, float radius) {
    FrameSums sums;
    const Vec3d origin = center.cast<double>();
    for (const IndexTriangle& triangle : triangles) {
        sums.add(moments_of(points, triangle), origin, radius);
    }
    return sums.frame();
}

}  // namespace ostraka
