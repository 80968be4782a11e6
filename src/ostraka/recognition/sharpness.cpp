// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/sharpness.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr double kStep = 4.0;         // sampling distances
constexpr std::size_t kPoints = 300;  // that are looked at
constexpr std::size_t kAxes = 3;

// Scan frame.
struct Patch {
    std::vector<Vec3f> points;
    std::vector<Vec3f> normals;
    Vec3d middle = Vec3d::Zero();
    Mat3d axes = Mat3d::Identity();  // columns: principal directions
    double radius = 0.0;             // RMS distance from the middle
};

Patch patch_of(const PointCloud& cloud, std::span<const std::uint32_t> indices) {
    Patch patch;
    const std::size_t stride = 1 + indices.size() / kPoints;
    for (std::size_t k = 0; k < indices.size(); k += stride) {
        patch.points.push_back(cloud.points[indices[k]]);
        patch.normals.push_back(cloud.normals[indices[k]]);
        patch.middle += patch.points.back().cast<double>();
    }
    const auto count = static_cast<double>(patch.points.size());
    patch.middle /= count;
    Mat3d scatter = Mat3d::Zero();
    for (const Vec3f& point : patch.points) {
        const Vec3d offset = point.cast<double>() - patch.middle;
        scatter += offset * offset.transpose() / count;
    }
    const Eigen::SelfAdjointEigenSolver<Mat3d> solver(scatter);
    patch.axes = solver.eigenvectors();
    patch.radius = std::sqrt(scatter.trace());
    return patch;
}

double disagreement(const Patch& patch, const ModelProbe& probe, const Pose& T_model_scene,
                    float reach) {
    const Mat3f R = T_model_scene.linear().cast<float>();
    const Vec3f t = T_model_scene.translation().cast<float>();
    double sum = 0.0;
    for (std::size_t i = 0; i < patch.points.size(); ++i) {
        const Vec3f at = R * patch.points[i] + t;
        const std::uint32_t nearest = probe.field().nearest(at);
        const bool near = nearest != kNoIndex &&
                          (at - probe.field().point(nearest)).squaredNorm() < reach * reach;
        const float cosine = near ? probe.field().normal(nearest).dot(R * patch.normals[i]) : 0.0F;
        sum += 1.0 - double{std::max(0.0F, cosine)};
    }
    return sum / static_cast<double>(patch.points.size());
}

}  // namespace

double sharpness(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model,
                 std::span<const std::uint32_t> points) {
    if (points.empty()) return 0.0;
    const Patch patch = patch_of(scan.cloud, points);
    const double step = kStep * scan.sampling;
    const double angle = step / std::max(patch.radius, step);
    const auto reach = static_cast<float>(step);
    const Pose T_model_scene = T_scene_model.inverse(Eigen::Isometry);
    const double here = disagreement(patch, probe, T_model_scene, reach);
    double least = 1.0;
    for (std::size_t k = 0; k < 2 * kAxes; ++k) {
        const Vec3d axis = (k % 2 == 0 ? 1.0 : -1.0) * patch.axes.col(static_cast<int>(k / 2));
        const Pose shift(Eigen::Translation3d(step * axis));
        const Pose turn(Eigen::Translation3d(patch.middle) * Eigen::AngleAxisd(angle, axis) *
                        Eigen::Translation3d(-patch.middle));
        for (const Pose& move : {shift, turn}) {
            least = std::min(least, disagreement(patch, probe, T_model_scene * move, reach) - here);
        }
    }
    return least;
}

}  // namespace ostraka
