// SPDX-License-Identifier: Apache-2.0
#include "ostraka/views/camera.hpp"

#include <cmath>

namespace ostraka {

Pose look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up) {
    const Vec3d forward = (target - eye).normalized();
    Vec3d right = forward.cross(up);
    if (!(right.norm() > 1e-6 * up.norm())) {
        const Vec3d other = std::abs(forward.x()) < 0.9 ? Vec3d::UnitX() : Vec3d::UnitY();
        right = forward.cross(other);
    }
    right.normalize();
    Mat3d R_camera_world;
    R_camera_world.row(0) = right.transpose();
    R_camera_world.row(1) = forward.cross(right).transpose();
    R_camera_world.row(2) = forward.transpose();
    Pose T_camera_world = Pose::Identity();
    T_camera_world.linear() = R_camera_world;
    T_camera_world.translation() = -(R_camera_world * eye);
    return T_camera_world;
}

}  // namespace ostraka
