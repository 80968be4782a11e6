// SPDX-License-Identifier: Apache-2.0
// Tombari, Salti, Di Stefano. Unique Signatures of Histograms for Local Surface Description.
// ECCV 2010, section 3.1. Where exactly half of the points lie on either side, the five points
// around the median distance decide, as in PCL 1.13.
#include "ostraka/descriptors/shot_frame.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <limits>
#include <tuple>

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kLanes = 4;  // partial sums, which are exact and so can be added in any order

// Sums of weight * offset * offset^T in the order xx, xy, xz, yy, yz, zz.
OSTRAKA_VECTOR_CLONES
void add_scatter(const Support& s, double radius, const TermRounder& rounded,
                 std::array<double, 6>& sums) {
    std::array<std::array<double, kLanes>, 6> lanes{};
    const auto add = [&](std::size_t i, std::size_t lane) {
        const double x = s.x[i];
        const double y = s.y[i];
        const double z = s.z[i];
        const double weight = radius - s.distance[i];
        const double wx = weight * x;
        const double wy = weight * y;
        lanes[0][lane] += rounded(wx * x);
        lanes[1][lane] += rounded(wx * y);
        lanes[2][lane] += rounded(wx * z);
        lanes[3][lane] += rounded(wy * y);
        lanes[4][lane] += rounded(wy * z);
        lanes[5][lane] += rounded(weight * z * z);
    };
    std::size_t i = 0;
    for (; i + kLanes <= s.count; i += kLanes) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) add(i + lane, lane);
    }
    for (; i < s.count; ++i) add(i, 0);
    for (std::size_t k = 0; k < sums.size(); ++k) {
        sums[k] = (lanes[k][0] + lanes[k][1]) + (lanes[k][2] + lanes[k][3]);
    }
}

struct Sides {
    std::int32_t points = 0;   // away from the keypoint
    std::int32_t forward = 0;  // of them, with a coordinate of at least 0 along the axis
};

OSTRAKA_VECTOR_CLONES
Sides count_sides(const Support& s, const Vec3d& axis) {
    const double ax = axis.x();
    const double ay = axis.y();
    const double az = axis.z();
    const float* x = s.x.data();
    const float* y = s.y.data();
    const float* z = s.z.data();
    const float* distance = s.distance.data();
    std::int32_t points = 0;
    std::int32_t forward = 0;
    for (std::size_t i = 0; i < s.count; ++i) {
        const double along = double{x[i]} * ax + double{y[i]} * ay + double{z[i]} * az;
        const std::int32_t away = distance[i] > 0.0F ? 1 : 0;
        points += away;
        forward += along >= 0.0 ? away : 0;
    }
    return {points, forward};
}

// Whether most of the five points around the median distance lie in the axis' direction.
bool median_points_agree(const Support& s, const Vec3d& axis) {
    std::vector<std::tuple<float, float, float, float>> sorted;
    for (std::size_t i = 0; i < s.count; ++i) {
        if (s.distance[i] > 0.0F) sorted.emplace_back(s.distance[i], s.x[i], s.y[i], s.z[i]);
    }
    std::sort(sorted.begin(), sorted.end());
    int forward = 0;
    const std::size_t middle = sorted.size() / 2;
    for (std::size_t i = middle - 2; i <= middle + 2; ++i) {
        const auto& [distance, x, y, z] = sorted[i];
        if (x * axis.x() + y * axis.y() + z * axis.z() > 0.0) ++forward;
    }
    return forward >= 3;
}

Vec3d majority_signed(const Support& s, const Vec3d& axis) {
    const Sides sides = count_sides(s, axis);
    const std::int32_t surplus = 2 * sides.forward - sides.points;
    const bool keep = surplus == 0 ? median_points_agree(s, axis) : surplus > 0;
    return keep ? axis : Vec3d(-axis);
}

}  // namespace

Mat3f shot_frame(const Support& support, float radius) {
    const Mat3f none = Mat3f::Constant(std::numeric_limits<float>::quiet_NaN());
    if (count_sides(support, Vec3d::UnitX()).points < 5) return none;
    const double reach = radius;
    const TermRounder rounded(support.count, reach * reach * reach);
    std::array<double, 6> sums{};
    add_scatter(support, reach, rounded, sums);
    Mat3d scatter;
    scatter << sums[0], sums[1], sums[2], sums[1], sums[3], sums[4], sums[2], sums[4], sums[5];
    if (!scatter.allFinite()) return none;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
    const Vec3d x = majority_signed(support, solver.eigenvectors().col(2));
    const Vec3d z = majority_signed(support, solver.eigenvectors().col(0));
    Mat3f frame;
    frame.row(0) = x.cast<float>();
    frame.row(2) = z.cast<float>();
    frame.row(1) = Vec3f(frame.row(2)).cross(Vec3f(frame.row(0)));
    return frame;
}

}  // namespace ostraka
