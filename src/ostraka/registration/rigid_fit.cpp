// SPDX-License-Identifier: Apache-2.0
#include "ostraka/registration/rigid_fit.hpp"

#include <Eigen/SVD>

#include "ostraka/base/error.hpp"

namespace ostraka {

Pose fit_rigid(std::span<const Vec3f> source, std::span<const Vec3f> target,
               std::span<const float> weights) {
    if (source.empty() || source.size() != target.size() ||
        (!weights.empty() && weights.size() != source.size())) {
        throw InvalidInput("rigid fit: needs equally many source and target points, at least one");
    }
    const auto weight = [&](std::size_t i) { return weights.empty() ? 1.0 : double{weights[i]}; };
    Vec3d source_mean = Vec3d::Zero();
    Vec3d target_mean = Vec3d::Zero();
    double total = 0.0;
    for (std::size_t i = 0; i < source.size(); ++i) {
        source_mean += weight(i) * source[i].cast<double>();
        target_mean += weight(i) * target[i].cast<double>();
        total += weight(i);
    }
    if (!(total > 0.0)) throw InvalidInput("rigid fit: all weights are zero");
    source_mean /= total;
    target_mean /= total;
    Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < source.size(); ++i) {
        cross += weight(i) * (target[i].cast<double>() - target_mean) *
                 (source[i].cast<double>() - source_mean).transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d signs = Eigen::Vector3d::Ones();
    // A reflection may fit better; the proper rotation gives up the weakest direction.
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) signs[2] = -1.0;
    Pose T_target_source = Pose::Identity();
    T_target_source.linear() = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
    T_target_source.translation() = target_mean - T_target_source.linear() * source_mean;
    return T_target_source;
}

}  // namespace ostraka
