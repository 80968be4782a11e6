// SPDX-License-Identifier: Apache-2.0
// The scalar, vector and pose types that every module shares.
// Fixed-size Eigen types are unaligned, so that code compiled with other vector flags can link.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

namespace ostraka {

using Vec2f = Eigen::Matrix<float, 2, 1, Eigen::DontAlign>;
using Vec3f = Eigen::Matrix<float, 3, 1, Eigen::DontAlign>;
using Vec2d = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;
using Vec3d = Eigen::Matrix<double, 3, 1, Eigen::DontAlign>;
using Mat3f = Eigen::Matrix<float, 3, 3, Eigen::DontAlign>;
using Mat3d = Eigen::Matrix<double, 3, 3, Eigen::DontAlign>;
using Mat4d = Eigen::Matrix<double, 4, 4, Eigen::DontAlign>;

/// A rigid motion. Variables name both frames: `T_scene_model` maps model points to scene points.
using Pose = Eigen::Transform<double, 3, Eigen::Isometry, Eigen::DontAlign>;

/// 8-bit red, green, blue.
using Color = std::array<std::uint8_t, 3>;

inline constexpr double kPi = 3.14159265358979323846;

/// Marks "none" where an index is expected.
inline constexpr std::uint32_t kNoIndex = 0xffffffffU;

}  // namespace ostraka
