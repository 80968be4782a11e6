// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/sharpness.hpp"

#include <algorithm>

#include "ostraka/cloud/principal_frame.hpp"

namespace ostraka {
namespace {

constexpr double kStep = 4.0;         // sampling distances
constexpr std::size_t kPoints = 300;  // that are looked at
constexpr std::size_t kAxes = 3;

PointCloud thinned(const PointCloud& cloud, std::span<const std::uint32_t> indices) {
    std::vector<std::uint32_t> some;
    const std::size_t stride = 1 + indices.size() / kPoints;
    for (std::size_t k = 0; k < indices.size(); k += stride) some.push_back(indices[k]);
    return select(cloud, some);
}

double disagreement(const PointCloud& patch, const ModelProbe& probe, const Pose& T_model_scene,
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
    const PointCloud patch = thinned(scan.cloud, points);
    const PrincipalFrame frame = principal_frame(patch);
    const Vec3d middle = frame.T_cloud_frame.translation();
    const double step = kStep * scan.sampling;
    const double angle = step / std::max(frame.deviations.norm(), step);
    const auto reach = static_cast<float>(step);
    const Pose T_model_scene = T_scene_model.inverse(Eigen::Isometry);
    const double here = disagreement(patch, probe, T_model_scene, reach);
    double least = 1.0;
    for (std::size_t k = 0; k < 2 * kAxes; ++k) {
        const Vec3d axis =
            (k % 2 == 0 ? 1.0 : -1.0) * frame.T_cloud_frame.linear().col(static_cast<int>(k / 2));
        const Pose shift(Eigen::Translation3d(step * axis));
        const Pose turn(Eigen::Translation3d(middle) * Eigen::AngleAxisd(angle, axis) *
                        Eigen::Translation3d(-middle));
        for (const Pose& move : {shift, turn}) {
            least = std::min(least, disagreement(patch, probe, T_model_scene * move, reach) - here);
        }
    }
    return least;
}

}  // namespace ostraka
