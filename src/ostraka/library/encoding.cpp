// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/encoding.hpp"

#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr double kSteps = 32000.0;  // a radius
constexpr double kMost = 32767.0;

}  // namespace

EncodedPoint encode_point(const Vec3f& point, const MeshShape& shape) {
    EncodedPoint encoded;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<Eigen::Index>(axis);
        const double steps = (double{point[a]} - shape.center[a]) / shape.radius * kSteps;
        encoded[axis] = static_cast<std::int16_t>(std::clamp(std::round(steps), -kMost, kMost));
    }
    return encoded;
}

Vec3f decode_point(const EncodedPoint& encoded, const MeshShape& shape) {
    Vec3f point;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<Eigen::Index>(axis);
        point[a] = static_cast<float>(shape.center[a] + encoded[axis] * shape.radius / kSteps);
    }
    return point;
}

}  // namespace ostraka
