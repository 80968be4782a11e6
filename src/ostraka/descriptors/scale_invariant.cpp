// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/scale_invariant.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/depth_patch.hpp"
#include "ostraka/descriptors/local_checks.hpp"
#include "ostraka/descriptors/spin_image_row.hpp"
#include "ostraka/descriptors/vertex_rings.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kChunk = 4;  // keypoints that share scratch memory
constexpr int kWidest = 64;
// A patch flatter than this, in half sides, is a plane up to rounding: its gradients mean nothing.
constexpr float kFlat = 1e-5F;

void require_scales(const PointCloud& cloud, std::span<const ScaleKeypoint> keypoints,
                    float support, std::string_view descriptor) {
    require_surfels(cloud, descriptor);
    require_radius(support, descriptor);
    for (const ScaleKeypoint& keypoint : keypoints) {
        const bool fits = keypoint.index < cloud.size() && keypoint.scale > 0.0F &&
                          keypoint.scale * support <= kLargestCoordinate;
        if (fits) continue;
        throw InvalidInput(fmt::format("{}: keypoint {} with scale {:g} in a cloud of {} points",
                                       descriptor, keypoint.index, keypoint.scale, cloud.size()));
    }
}

// Radius for a grid that serves all keypoints: their geometric mean.
float typical_radius(std::span<const ScaleKeypoint> keypoints, double factor) {
    double sum = 0.0;
    for (const ScaleKeypoint& keypoint : keypoints) sum += std::log(double{keypoint.scale});
    const double count = static_cast<double>(std::max<std::size_t>(1, keypoints.size()));
    return static_cast<float>(factor * std::exp(sum / count));
}

// R_local_cloud with z the normal and y the direction of the greatest spread in the tangent plane;
// NaN without one.
Mat3d upright_frame(const SurfelColumns& around, const Vec3d& normal) {
    const Vec3d z = normal.normalized();
    const Vec3d least = std::abs(z.x()) < 0.6 ? Vec3d::UnitX() : Vec3d::UnitY();
    const Vec3d u = z.cross(least).normalized();
    const Vec3d v = z.cross(u);
    const auto count = static_cast<double>(around.count);
    Vec3d mean = Vec3d::Zero();
    for (std::size_t i = 0; i < around.count; ++i) {
        mean += Vec3d(around.x[i], around.y[i], around.z[i]) / count;
    }
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (std::size_t i = 0; i < around.count; ++i) {
        const Vec3d offset = Vec3d(around.x[i], around.y[i], around.z[i]) - mean;
        const Eigen::Vector2d flat(offset.dot(u), offset.dot(v));
        spread += flat * flat.transpose();
    }
    Mat3d frame = Mat3d::Constant(std::numeric_limits<double>::quiet_NaN());
    if (around.count < 3 || !(spread.trace() > 0.0)) return frame;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread);
    const Eigen::Vector2d direction = solver.eigenvectors().col(1);
    const Vec3d y = (direction.x() * u + direction.y() * v).normalized();
    frame.row(0) = y.cross(z);
    frame.row(1) = y;
    frame.row(2) = z;
    return frame;
}

// The surface around a keypoint, in half sides of the patch.
DepthPatch draw_patch(const PointCloud& cloud, std::span<const IndexTriangle> triangles,
                      const PointLists& triangles_at, std::span<const std::uint32_t> support,
                      const Vec3d& center, const Mat3d& frame, double half_side) {
    DepthPatch patch;
    // The corners of the patch are farther than its sides, and heights count, too.
    const double reach = std::sqrt(3.0);
    for (const std::uint32_t point : support) {
        for (const std::uint32_t t : triangles_at.of(point)) {
            if (*std::min_element(triangles[t].begin(), triangles[t].end()) != point) continue;
            std::array<Vec3d, 3> corners;
            bool inside = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3d offset = cloud.points[triangles[t][k]].cast<double>() - center;
                corners[k] = frame * offset / half_side;
                inside = inside && corners[k].squaredNorm() < reach * reach;
            }
            if (inside) draw_triangle(corners, patch);
        }
    }
    return patch;
}

void describe_patch(DepthPatch& patch, std::span<float> row) {
    if (!fill_background(patch)) return;
    const auto [low, high] = std::minmax_element(patch.height.begin(), patch.height.end());
    if (!(*high - *low > kFlat)) return;
    add_sift(patch, row);
    add_sift(turned_by_half(patch), row);
    double squares = 0.0;
    for (const float value : row) squares += double{value} * value;
    const double scale = squares > 0.0 ? 1.0 / std::sqrt(squares) : 0.0;
    for (float& value : row) value = static_cast<float>(scale * value);
}

}  // namespace

LocalDescriptors describe_sisi(const PointCloud& cloud, std::span<const ScaleKeypoint> keypoints,
                               const SisiSettings& settings) {
    require_scales(cloud, keypoints, settings.support, "sisi");
    if (settings.width < 1 || settings.width > kWidest) {
        throw InvalidInput(fmt::format("sisi: width {}, must be 1 to {}", settings.width, kWidest));
    }
    const std::size_t length = sisi_length(settings);
    LocalDescriptors result;
    result.rows.assign(keypoints.size() * length, 0.0F);
    if (keypoints.empty()) return result;
    // The ball around the cylinder, a little wider so that rounding loses nothing.
    const double ball = 1.0001 * std::sqrt(2.0) * double{settings.support};
    const SurfelGrid grid(cloud.points, cloud.normals, typical_radius(keypoints, ball));
    parallel_for((keypoints.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        SurfelColumns around;
        SpinScratch scratch;
        const std::size_t end = std::min(keypoints.size(), (chunk + 1) * kChunk);
        for (std::size_t k = chunk * kChunk; k < end; ++k) {
            const Vec3f& center = cloud.points[keypoints[k].index];
            const Vec3f& normal = cloud.normals[keypoints[k].index];
            if (!normal.allFinite()) continue;
            const double scale = keypoints[k].scale;
            grid.gather(center, static_cast<float>(ball * scale), around);
            const SpinCylinder cylinder{.center = center,
                                        .axis = normal,
                                        .bin = double{settings.support} * scale / settings.width,
                                        .width = settings.width,
                                        .support_cosine = 0.0F,
                                        .either_side = false};
            draw_spin_image(around, cylinder, scratch,
                            std::span(result.rows).subspan(k * length, length));
        }
    });
    return result;
}

LocalDescriptors describe_ld_sift(const PointCloud& cloud, std::span<const IndexTriangle> triangles,
                                  std::span<const ScaleKeypoint> keypoints,
                                  const LdSiftSettings& settings) {
    require_scales(cloud, keypoints, settings.support, "ld-sift");
    require_triangles(triangles, cloud.size(), "ld-sift");
    LocalDescriptors result;
    result.rows.assign(keypoints.size() * kLdSiftLength, 0.0F);
    result.frames.assign(keypoints.size(),
                         Mat3f::Constant(std::numeric_limits<float>::quiet_NaN()));
    if (keypoints.empty()) return result;
    const PointLists triangles_at = vertex_triangles(cloud.size(), triangles);
    const SurfelGrid grid(cloud.points, {}, typical_radius(keypoints, settings.support));
    parallel_for((keypoints.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        SurfelColumns around;
        std::vector<std::uint32_t> support;
        const std::size_t end = std::min(keypoints.size(), (chunk + 1) * kChunk);
        for (std::size_t k = chunk * kChunk; k < end; ++k) {
            const Vec3f& center = cloud.points[keypoints[k].index];
            const Vec3f& normal = cloud.normals[keypoints[k].index];
            if (!normal.allFinite()) continue;
            const double half_side = double{settings.support} * double{keypoints[k].scale};
            grid.gather(center, static_cast<float>(half_side), around);
            const Mat3d frame = upright_frame(around, normal.cast<double>());
            if (!frame.allFinite()) continue;
            grid.gather(center, static_cast<float>(2.0 * half_side), around);
            support.clear();
            for (std::size_t i = 0; i < around.count; ++i) {
                support.push_back(grid.original()[around.slot[i]]);
            }
            DepthPatch patch = draw_patch(cloud, triangles, triangles_at, support,
                                          center.cast<double>(), frame, half_side);
            describe_patch(patch, std::span(result.rows).subspan(k * kLdSiftLength, kLdSiftLength));
            result.frames[k] = frame.cast<float>();
        }
    });
    return result;
}

}  // namespace ostraka
