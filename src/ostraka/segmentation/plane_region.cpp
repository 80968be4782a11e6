// SPDX-License-Identifier: Apache-2.0
#include "ostraka/segmentation/plane_region.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace ostraka {
namespace {

using Vec6d = Eigen::Matrix<double, 6, 1>;
using Mat6d = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kMinPoints = 12;  // for the six coefficients of a paraboloid
constexpr double kSignificance = 3.0;   // standard errors of the arch's height
constexpr double kArchError = 2.24;  // standard error of an arch's height / (noise / sqrt(count))

struct Paraboloid {
    Mat3d frame = Mat3d::Identity();  // columns: two directions in the plane, the normal
    Vec6d terms = Vec6d::Zero();      // of 1, u, v, u u / 2, u v, v v / 2
    Mat6d moments = Mat6d::Zero();
    double noise = 0.0;  // root mean square residual
};

Vec6d terms_at(const Vec3d& local) {
    const double u = local.x();
    const double v = local.y();
    return Vec6d(1.0, u, v, 0.5 * u * u, u * v, 0.5 * v * v);
}

Paraboloid fit_paraboloid(const PointCloud& cloud, std::span<const std::uint32_t> indices,
                          const PlaneRegion& plane) {
    Paraboloid fit;
    fit.frame.col(2) = plane.normal();
    fit.frame.col(0) = plane.normal().unitOrthogonal();
    fit.frame.col(1) = plane.normal().cross(Vec3d(fit.frame.col(0)));
    Vec6d right = Vec6d::Zero();
    double squares = 0.0;
    for (const std::uint32_t i : indices) {
        const Vec3d local =
            fit.frame.transpose() * (cloud.points[i].cast<double>() - plane.center());
        const Vec6d terms = terms_at(local);
        fit.moments += terms * terms.transpose();
        right += local.z() * terms;
        squares += local.z() * local.z();
    }
    fit.terms = fit.moments.ldlt().solve(right);
    const double left = std::max(0.0, squares - fit.terms.dot(right));
    fit.noise = std::sqrt(left / static_cast<double>(indices.size()));
    return fit;
}

}  // namespace

void PlaneRegion::add(const PointCloud& cloud, std::span<const std::uint32_t> indices) {
    for (const std::uint32_t i : indices) {
        const Vec3d offset = cloud.points[i].cast<double>() - origin_;
        sum_ += offset;
        squares_ += offset * offset.transpose();
    }
    count_ += indices.size();
}

void PlaneRegion::fit(const Vec3d& like) {
    const auto count = static_cast<double>(count_);
    const Vec3d mean = sum_ / count;
    const Eigen::Matrix3d covariance = squares_ / count - mean * mean.transpose();
    center_ = origin_ + mean;
    normal_ = like;
    roughness_ = std::sqrt(std::max(0.0, like.dot(covariance * like)));
    if (count_ < 3) return;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(covariance);
    const Vec3d least = solver.eigenvectors().col(0);
    // A line of points has no plane of its own.
    if (!(solver.eigenvalues()[1] > 1e-6 * solver.eigenvalues()[2]) || !least.allFinite()) return;
    normal_ = least.dot(like) < 0.0 ? Vec3d(-least) : least;
    roughness_ = std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
}

double bend_of(const PointCloud& cloud, std::span<const std::uint32_t> indices,
               const PlaneRegion& plane) {
    if (indices.size() < kMinPoints) return 0.0;
    const Paraboloid fit = fit_paraboloid(cloud, indices, plane);
    Eigen::Matrix2d curvature;
    curvature << fit.terms[3], fit.terms[4], fit.terms[4], fit.terms[5];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(curvature);
    const auto count = static_cast<double>(indices.size());
    double bend = 0.0;
    for (int k = 0; k < 2; ++k) {
        // Half the width of a uniform strip of the same variance.
        const Eigen::Vector2d along = solver.eigenvectors().col(k);
        const Eigen::Vector2d mean = fit.moments.block<2, 1>(1, 0) / count;
        Eigen::Matrix2d spread;
        spread << 2.0 * fit.moments(0, 3), fit.moments(0, 4), fit.moments(0, 4),
            2.0 * fit.moments(0, 5);
        spread = spread / count - mean * mean.transpose();
        const double half = std::sqrt(std::max(0.0, 3.0 * along.dot(spread * along)));
        const double steepness = std::abs(solver.eigenvalues()[k]);
        const double arch = 0.5 * steepness * half * half;
        if (arch <= kSignificance * kArchError * fit.noise / std::sqrt(count)) continue;
        bend = std::max(bend, 2.0 * steepness * half);
    }
    return bend;
}

}  // namespace ostraka
