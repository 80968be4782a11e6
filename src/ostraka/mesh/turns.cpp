// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/turns.hpp"

#include <Eigen/SVD>

namespace ostraka {

Mat3d rotation_about(const Vec3d& direction, double angle) {
    return Eigen::AngleAxisd(angle, direction).toRotationMatrix();
}

Pose turn_at(const Vec3d& center, const Mat3d& rotation) {
    Pose turn = Pose::Identity();
    turn.linear() = rotation;
    turn.translation() = center - rotation * center;
    return turn;
}

Pose turn_about(const Line& line, double angle) {
    return turn_at(line.point, rotation_about(line.direction, angle));
}

Vec3d fixed_point(std::span<const Pose> motions) {
    // Least squares of (1 - R) x = t. What nothing decides stays 0.
    Mat3d matrix = Mat3d::Zero();
    Vec3d right = Vec3d::Zero();
    for (const Pose& motion : motions) {
        const Mat3d moves = Mat3d::Identity() - motion.linear();
        matrix += moves.transpose() * moves;
        right += moves.transpose() * motion.translation();
    }
    Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
    svd.setThreshold(1e-3);
    return svd.solve(Eigen::Vector3d(right));
}

Line axis_of(const Pose& motion, double& angle) {
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(motion.linear()));
    angle = turn.angle();
    const Vec3d point = fixed_point({&motion, 1});
    return {.direction = turn.axis(), .point = point - turn.axis().dot(point) * turn.axis()};
}

}  // namespace ostraka
