// SPDX-License-Identifier: Apache-2.0
// Sums of point-to-plane registration: each pair of a moved point and a plane makes a row of a
// least-squares problem for a small turn and shift.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "ostraka/base/types.hpp"

namespace ostraka {

using Vec6d = Eigen::Matrix<double, 6, 1>;
using Mat6d = Eigen::Matrix<double, 6, 6>;

/// The normal equations, left * (turn, shift) = right, and the squares of what is to be minimized.
class PlaneSums {
  public:
    Mat6d left() const;
    Vec6d right() const;
    double squares() const { return sums_[kSums - 1]; }
    std::size_t pairs() const { return pairs_; }
    PlaneSums& operator+=(const PlaneSums& other);

  private:
    friend class PlanePairs;
    // Of the products of (turn, normal, residual): the upper triangle, row by row.
    static constexpr std::size_t kSums = 28;
    std::array<double, kSums> sums_{};
    std::size_t pairs_ = 0;
};

/// A turn about `pivot` by turn's length, in radians, about its direction; then a shift.
Pose step_about(const Vec3d& pivot, const Vec3d& turn, const Vec3d& shift);

/// Pairs side by side, so that several are summed at a time; the same bits on every machine.
class PlanePairs {
  public:
    static constexpr std::size_t kMost = 256;

    std::size_t size() const { return count_; }
    /// At most kMost.
    /// @param turn      (point - pivot) x normal, about the pivot that the step will turn about.
    /// @param residual  normal . (point - plane). A weight w is its square root times all three.
    void add(const Vec3d& turn, const Vec3d& normal, double residual) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<Eigen::Index>(axis);
            columns_[axis][count_] = turn[a];
            columns_[axis + 3][count_] = normal[a];
        }
        columns_[6][count_] = residual;
        ++count_;
    }
    /// Of all pairs added since the last call.
    PlaneSums take();

  private:
    std::array<std::array<double, kMost>, 7> columns_;  // turn, normal, residual
    std::size_t count_ = 0;
};

}  // namespace ostraka
