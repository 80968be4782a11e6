// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/rigid_matrix.hpp"

#include <algorithm>
#include <array>

namespace ostraka {
namespace {

constexpr double kOrthonormal = 0.02;
constexpr double kLastRow = 1e-6;

}  // namespace

RigidMatrix rigid_from(std::span<const double> numbers) {
    constexpr std::array<double, 4> kLast = {0.0, 0.0, 0.0, 1.0};
    const auto last = numbers.subspan(12, 4);
    if (!std::equal(last.begin(), last.end(), kLast.begin(),
                    [](double a, double b) { return std::abs(a - b) <= kLastRow; })) {
        return {.problem = "has a last row other than 0 0 0 1"};
    }
    std::array<double, 9> rotation;
    std::array<double, 3> translation;
    for (std::size_t row = 0; row < 3; ++row) {
        std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(4 * row), 3,
                    rotation.begin() + static_cast<std::ptrdiff_t>(3 * row));
        translation[row] = numbers[4 * row + 3];
    }
    return rigid_from(rotation, translation);
}

RigidMatrix rigid_from(std::span<const double> rotation, std::span<const double> translation) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rows(rotation.data());
    const Eigen::Matrix3d matrix = rows;
    const Eigen::Matrix3d off = matrix * matrix.transpose() - Eigen::Matrix3d::Identity();
    if (!(off.cwiseAbs().maxCoeff() <= kOrthonormal) || matrix.determinant() < 0.0) {
        return {.problem = "is not a rotation"};
    }
    RigidMatrix result;
    result.pose.linear() = Eigen::Quaterniond(matrix).normalized().toRotationMatrix();
    result.pose.translation() = Vec3d(translation[0], translation[1], translation[2]);
    return result;
}

}  // namespace ostraka
