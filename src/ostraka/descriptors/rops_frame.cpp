// SPDX-License-Identifier: Apache-2.0
// Guo et al. Rotational Projection Statistics for 3D Local Surface Description and Object
// Recognition. IJCV 105(1), 2013, section 3.1. With g the mean of a triangle's corners a_i and p
// the keypoint, the paper's double sum over the corners (eq. 3) is
//   sum_i sum_j (a_i - p)(a_j - p)^T + sum_i (a_i - p)(a_i - p)^T
//     = sum_i (a_i - g)(a_i - g)^T + 12 (g - p)(g - p)^T,
// of which the first part doesn't depend on the keypoint. Triangles near a keypoint are swept in
// the order of cells, four in a vector; a triangle is 36 bytes for the test and 80 for the sums,
// and 60 operations, so four take at least 25 cycles. About half of those swept count.
#include "ostraka/descriptors/rops_frame.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/vector_clones.hpp"
#include "ostraka/descriptors/support.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kLanes = 4;
using Int4 = std::int32_t __attribute__((vector_size(16)));

// Weighted sums over triangles, in four parts that are added at the end.
struct FrameSums {
    std::array<std::array<double, kLanes>, 6> scatter{};
    std::array<std::array<double, kLanes>, 3> side{};  // where the surface lies, for the signs
};

struct Sphere {
    double x, y, z, radius;
};

// Adds four triangles from `i` on, of which the marked ones count.
__attribute__((always_inline)) inline void add_four(const TriangleColumns& t, std::size_t i,
                                                    const Sphere& s, const Double4& mark,
                                                    Double4 (&scatter)[6], Double4 (&side)[3]) {
    Double4 x;
    Double4 y;
    Double4 z;
    Double4 weight;
    load4(t.x.data() + i, x);
    load4(t.y.data() + i, y);
    load4(t.z.data() + i, z);
    load4(t.area.data() + i, weight);
    x -= s.x;
    y -= s.y;
    z -= s.z;
    const Double4 squared = x * x + y * y + z * z;
    double distances[kLanes];
    std::memcpy(&distances, &squared, sizeof(squared));
    for (double& distance : distances) distance = std::sqrt(distance);
    Double4 nearness;
    std::memcpy(&nearness, &distances, sizeof(nearness));
    nearness = s.radius - nearness;
    weight *= nearness * nearness * mark;
    const Double4 wx = 12.0 * weight * x;
    const Double4 wy = 12.0 * weight * y;
    const Double4 products[6] = {wx * x, wx * y, wx * z, wy * y, wy * z, 12.0 * weight * z * z};
    for (std::size_t k = 0; k < 6; ++k) {
        Double4 spread;
        load4(t.spread[k].data() + i, spread);
        scatter[k] += weight * spread + products[k];
    }
    side[0] += weight * x;
    side[1] += weight * y;
    side[2] += weight * z;
}

// Of eight triangles from `i` on: -1 for each with a corner in the sphere, else 0.
__attribute__((always_inline)) inline void mark_eight(const TriangleColumns& t, std::size_t i,
                                                      const Vec3f& center, float squared_radius,
                                                      Int8& marks) {
    marks = Int8{};
    for (std::size_t corner = 0; corner < 9; corner += 3) {
        Float8 x;
        Float8 y;
        Float8 z;
        load8(t.corner[corner].data() + i, x);
        load8(t.corner[corner + 1].data() + i, y);
        load8(t.corner[corner + 2].data() + i, z);
        x -= center.x();
        y -= center.y();
        z -= center.z();
        marks |= x * x + y * y + z * z < squared_radius;
    }
}

// Adds the triangles in [first, end) that have a corner in the sphere, or all.
OSTRAKA_VECTOR_CLONES
void add_triangles(const TriangleColumns& t, std::size_t first, std::size_t end, const Sphere& s,
                   bool all, FrameSums& sums) {
    Double4 scatter[6];
    Double4 side[3];
    std::memcpy(&scatter, &sums.scatter, sizeof(scatter));
    std::memcpy(&side, &sums.side, sizeof(side));
    const Vec3f center(static_cast<float>(s.x), static_cast<float>(s.y), static_cast<float>(s.z));
    const float squared_radius = static_cast<float>(s.radius) * static_cast<float>(s.radius);
    const Int8 lanes = {0, 1, 2, 3, 4, 5, 6, 7};
    for (std::size_t i = first; i < end; i += kVectorLanes) {
        Int8 marks = Int8{} - 1;
        if (!all) mark_eight(t, i, center, squared_radius, marks);
        if (end - i < kVectorLanes) marks &= lanes < static_cast<std::int32_t>(end - i);
        std::uint64_t words[4];
        std::memcpy(&words, &marks, sizeof(words));
        Int4 half;
        if ((words[0] | words[1]) != 0) {
            std::memcpy(&half, words, sizeof(half));
            add_four(t, i, s, -__builtin_convertvector(half, Double4), scatter, side);
        }
        if ((words[2] | words[3]) != 0) {
            std::memcpy(&half, words + 2, sizeof(half));
            add_four(t, i + kLanes, s, -__builtin_convertvector(half, Double4), scatter, side);
        }
    }
    std::memcpy(&sums.scatter, &scatter, sizeof(scatter));
    std::memcpy(&sums.side, &side, sizeof(side));
}

double total(const std::array<double, kLanes>& parts) {
    return (parts[0] + parts[1]) + (parts[2] + parts[3]);
}

Mat3f frame_of(const FrameSums& sums) {
    const double xx = total(sums.scatter[0]);
    const double xy = total(sums.scatter[1]);
    const double xz = total(sums.scatter[2]);
    const double yy = total(sums.scatter[3]);
    const double yz = total(sums.scatter[4]);
    const double zz = total(sums.scatter[5]);
    const Vec3d side(total(sums.side[0]), total(sums.side[1]), total(sums.side[2]));
    const double trace = xx + yy + zz;
    if (!(trace > 0.0) || !std::isfinite(trace)) return no_frame();
    Mat3d matrix;
    matrix << xx, xy, xz, xy, yy, yz, xz, yz, zz;
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

std::vector<Vec3f> centers_of(std::span<const Vec3f> points,
                              std::span<const IndexTriangle> triangles) {
    std::vector<Vec3f> centers(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto& [a, b, c] = triangles[t];
        centers[t] = (points[a] + points[b] + points[c]) / 3.0F;
    }
    return centers;
}

}  // namespace

TriangleColumns::TriangleColumns(std::size_t triangles, bool with_corners) {
    for (auto* column : {&x, &y, &z, &area}) column->resize(triangles + kVectorLanes);
    for (auto& column : spread) column.resize(triangles + kVectorLanes);
    if (!with_corners) return;
    for (auto& column : corner) column.resize(triangles + kVectorLanes);
}

void TriangleColumns::set(std::size_t at, std::span<const Vec3f> points,
                          const IndexTriangle& triangle) {
    const std::array<Vec3d, 3> corners = {points[triangle[0]].cast<double>(),
                                          points[triangle[1]].cast<double>(),
                                          points[triangle[2]].cast<double>()};
    const Vec3d center = (corners[0] + corners[1] + corners[2]) / 3.0;
    x[at] = center.x();
    y[at] = center.y();
    z[at] = center.z();
    area[at] = (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
    std::array<double, 6> sums{};
    for (const Vec3d& point : corners) {
        const Vec3d d = point - center;
        sums[0] += d.x() * d.x();
        sums[1] += d.x() * d.y();
        sums[2] += d.x() * d.z();
        sums[3] += d.y() * d.y();
        sums[4] += d.y() * d.z();
        sums[5] += d.z() * d.z();
    }
    for (std::size_t k = 0; k < 6; ++k) spread[k][at] = sums[k];
    for (std::size_t k = 0; k < 9 && !corner[k].empty(); ++k) {
        corner[k][at] = points[triangle[k / 3]][static_cast<Eigen::Index>(k % 3)];
    }
}

RopsSurface::RopsSurface(std::span<const Vec3f> points, std::span<const IndexTriangle> triangles,
                         float radius)
    : RopsSurface(points, triangles, radius, centers_of(points, triangles)) {}

RopsSurface::RopsSurface(std::span<const Vec3f> points, std::span<const IndexTriangle> triangles,
                         float radius, std::span<const Vec3f> centers)
    : radius_(radius), order_(centers, 0.5F * radius), columns_(triangles.size(), true) {
    float longest = 0.0F;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (const std::uint32_t corner : triangles[t]) {
            longest = std::max(longest, (points[corner] - centers[t]).squaredNorm());
        }
    }
    longest_arm_ = 1.0001F * std::sqrt(longest);
    const std::span<const std::uint32_t> order = order_.order();
    for (std::size_t i = 0; i < order.size(); ++i) columns_.set(i, points, triangles[order[i]]);
}

Mat3f RopsSurface::local_frame(const Vec3f& keypoint) const {
    FrameSums sums;
    const Vec3d center = keypoint.cast<double>();
    const Sphere sphere{center.x(), center.y(), center.z(), radius_};
    order_.for_runs(keypoint, radius_ + longest_arm_, [&](std::size_t first, std::size_t end) {
        add_triangles(columns_, first, end, sphere, false, sums);
    });
    return frame_of(sums);
}

Mat3f whole_frame(std::span<const Vec3f> points, std::span<const IndexTriangle> triangles,
                  const Vec3f& center, float radius) {
    TriangleColumns columns(triangles.size(), false);
    for (std::size_t t = 0; t < triangles.size(); ++t) columns.set(t, points, triangles[t]);
    FrameSums sums;
    const Vec3d origin = center.cast<double>();
    add_triangles(columns, 0, triangles.size(), {origin.x(), origin.y(), origin.z(), radius}, true,
                  sums);
    return frame_of(sums);
}

}  // namespace ostraka
