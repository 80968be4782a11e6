// SPDX-License-Identifier: Apache-2.0
// Nearly a group becomes one by averaging: Grove, Karcher, Ruh. Group Actions and Curvature.
// Inventiones mathematicae 23, 1974.
#include "ostraka/mesh/symmetry_group.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr std::size_t kLargest = 60;  // turns of an icosahedron
// Different turns of a polyhedral group differ by at least 72 degrees: 2 cos(72 degrees) + 1 is the
// trace between them. 25 degrees leave room for what is measured.
constexpr double kSameTrace = 1.0 + 2.0 * 0.906;
constexpr int kAveragings = 8;  // each squares the error

double trace_between(const Mat3d& a, const Mat3d& b) {
    return a.cwiseProduct(b).sum();
}

// Index of the group's element that is the matrix, or its size.
std::size_t find(const std::vector<Mat3d>& group, const Mat3d& matrix) {
    std::size_t i = 0;
    while (i < group.size() && trace_between(group[i], matrix) < kSameTrace) ++i;
    return i;
}

Mat3d nearest_rotation(const Mat3d& matrix) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0.0) u.col(2) = -u.col(2);
    return u * svd.matrixV().transpose();
}

// All products, the identity first; empty if there are too many.
std::vector<Mat3d> closure(const Mat3d& first, const Mat3d& second) {
    std::vector<Mat3d> group = {Mat3d::Identity()};
    for (std::size_t i = 0; i < group.size(); ++i) {
        for (const Mat3d& generator : {first, second}) {
            const Mat3d product = generator * group[i];
            if (find(group, product) < group.size()) continue;
            if (group.size() == kLargest) return {};
            group.push_back(product);
        }
    }
    return group;
}

}  // namespace

Vec3d upward(const Vec3d& direction) {
    constexpr double kZero = 1e-3;  // as measured axes of a model that lies straight may be off
    for (int k = 2; k >= 0; --k) {
        if (std::abs(direction[k]) > kZero) return direction * (direction[k] < 0.0 ? -1.0 : 1.0);
    }
    return direction;
}

std::vector<Mat3d> cyclic_group(const Vec3d& main, int order) {
    std::vector<Mat3d> group;
    for (int k = 0; k < order; ++k) group.push_back(rotation_about(main, 2.0 * kPi * k / order));
    group[0] = Mat3d::Identity();
    return group;
}

std::vector<Mat3d> dihedral_group(const Vec3d& main, const Vec3d& across, int order) {
    std::vector<Mat3d> group = cyclic_group(main, order);
    const Vec3d side = (across - main.dot(across) * main).normalized();
    for (int k = 0; k < order; ++k) {
        const Vec3d axis = rotation_about(main, kPi * k / order) * side;
        group.push_back(2.0 * axis * axis.transpose() - Mat3d::Identity());
    }
    return group;
}

std::vector<Mat3d> polyhedral_group(const Mat3d& first, const Mat3d& second) {
    std::vector<Mat3d> group = closure(first, second);
    const std::size_t size = group.size();
    if (size != 12 && size != 24 && size != 60) return {};
    std::vector<std::size_t> products(size * size);
    for (std::size_t i = 0; i < size; ++i) {
        for (std::size_t j = 0; j < size; ++j) {
            products[i * size + j] = find(group, group[i] * group[j]);
            if (products[i * size + j] == size) return {};
        }
    }
    // Each element becomes the mean of what it should be: g = (g h) / h for all h.
    for (int k = 0; k < kAveragings; ++k) {
        std::vector<Mat3d> sums(size, Mat3d::Zero());
        for (std::size_t i = 0; i < size; ++i) {
            for (std::size_t j = 0; j < size; ++j) {
                sums[i] += group[products[i * size + j]] * group[j].transpose();
            }
        }
        std::transform(sums.begin(), sums.end(), group.begin(), nearest_rotation);
        group[0] = Mat3d::Identity();
    }
    return group;
}

}  // namespace ostraka
