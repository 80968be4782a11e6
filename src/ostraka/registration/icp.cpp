// SPDX-License-Identifier: Apache-2.0
#include "ostraka/registration/icp.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

using Vec6d = Eigen::Matrix<double, 6, 1>;
using Mat6d = Eigen::Matrix<double, 6, 6>;

// Normal equations of one step, for a small turn about `pivot` and a shift.
struct Equations {
    Mat6d left = Mat6d::Zero();
    Vec6d right = Vec6d::Zero();
    double squares = 0.0;
    int pairs = 0;
};

Equations assemble(const SurfaceField& target, std::span<const Vec3f> source,
                   std::span<const Vec3f> source_normals, const Pose& T_target_source,
                   const Vec3d& pivot, double distance, double min_cosine) {
    const Mat3f R = T_target_source.linear().cast<float>();
    const Vec3f t = T_target_source.translation().cast<float>();
    const auto limit = static_cast<float>(distance);
    const auto cosine = static_cast<float>(min_cosine);
    Equations sums;
    for (std::size_t i = 0; i < source.size(); ++i) {
        const Vec3f moved = R * source[i] + t;
        const std::uint32_t partner = target.nearest(moved);
        if (partner == kNoIndex) continue;
        const Vec3f& normal = target.normal(partner);
        const Vec3f offset = moved - target.point(partner);
        if (offset.squaredNorm() > limit * limit) continue;
        if (normal.dot(R * source_normals[i]) < cosine) continue;
        const double residual = double{normal.dot(offset)};
        const double ratio = residual / distance;
        const double weight = (1.0 - ratio * ratio) * (1.0 - ratio * ratio);
        const Vec3d n = normal.cast<double>();
        Vec6d row;
        row << (moved.cast<double>() - pivot).cross(n), n;
        sums.left.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
        sums.right -= weight * residual * row;
        sums.squares += residual * residual;
        ++sums.pairs;
    }
    return sums;
}

}  // namespace

IcpResult icp(const SurfaceField& target, std::span<const Vec3f> source,
              std::span<const Vec3f> source_normals, const Pose& T_target_source,
              const IcpSettings& settings) {
    if (source.size() != source_normals.size()) throw InvalidInput("ICP: normals are missing");
    if (!(settings.start_distance > 0.0) || !(settings.end_distance > 0.0)) {
        throw InvalidInput("ICP: start_distance and end_distance must be positive");
    }
    IcpResult result;
    result.T_target_source = T_target_source;
    if (source.empty()) return result;
    const Vec3d source_center = centroid(source);
    double radius = 0.0;
    for (const Vec3f& point : source) {
        radius = std::max(radius, (point.cast<double>() - source_center).norm());
    }
    const double shrink =
        std::pow(settings.end_distance / settings.start_distance, 2.0 / settings.iterations);
    double distance = settings.start_distance;
    for (int i = 0; i < settings.iterations; ++i) {
        const Vec3d pivot = result.T_target_source * source_center;
        Equations sums = assemble(target, source, source_normals, result.T_target_source, pivot,
                                  distance, settings.min_cosine);
        result.inliers = sums.pairs;
        if (sums.pairs < 6) return result;
        result.rms = std::sqrt(sums.squares / sums.pairs);
        // A little damping keeps what a plane or a sphere leaves free from drifting.
        Vec6d damping = Vec6d::Constant(1e-6 * sums.pairs);
        damping.head<3>() *= radius * radius;
        sums.left.diagonal() += damping;
        const Vec6d step =
            Mat6d(sums.left.selfadjointView<Eigen::Lower>()).ldlt().solve(sums.right);
        const Vec3d turn = step.head<3>();
        const double angle = turn.norm();
        Pose T_step = Pose::Identity();
        T_step.translate(Vec3d(pivot + step.tail<3>()));
        if (angle > 0.0) T_step.rotate(Eigen::AngleAxisd(angle, turn / angle));
        T_step.translate(Vec3d(-pivot));
        result.T_target_source = T_step * result.T_target_source;
        result.iterations = i + 1;
        const double moved = angle * radius + step.tail<3>().norm();
        const bool finest = distance <= settings.end_distance;
        if (finest && moved < settings.convergence * settings.end_distance) {
            result.converged = true;
            return result;
        }
        distance = std::max(settings.end_distance, distance * shrink);
    }
    return result;
}

}  // namespace ostraka
