// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/principal_frame.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

// Skewness (third moment over deviation cubed) below which noise or a cut may flip the sign.
constexpr double kMinSkewness = 0.25;
// Ratio of the two longer deviations above which they may trade places.
constexpr double kEqualRatio = 0.85;

double skewness(std::span<const Vec3f> points, const Vec3d& origin, const Vec3d& axis,
                double deviation) {
    double sum = 0.0;
    for (const Vec3f& point : points) {
        const double along = (point.cast<double>() - origin).dot(axis);
        sum += along * along * along;
    }
    const double cube = deviation * deviation * deviation * static_cast<double>(points.size());
    return cube > 0.0 ? sum / cube : 0.0;
}

}  // namespace

PrincipalFrame principal_frame(const PointCloud& cloud) {
    if (cloud.empty()) throw InvalidInput("principal frame of an empty cloud");
    const Vec3d origin = centroid(cloud.points);
    Mat3d covariance = Mat3d::Zero();
    for (const Vec3f& point : cloud.points) {
        const Vec3d offset = point.cast<double>() - origin;
        covariance += offset * offset.transpose();
    }
    covariance /= static_cast<double>(cloud.size());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    PrincipalFrame frame;
    frame.deviations = solver.eigenvalues().reverse().cwiseMax(0.0).cwiseSqrt();
    Vec3d z = solver.eigenvectors().col(0);
    if (z.dot(cloud.viewpoint.cast<double>() - origin) < 0.0) z = -z;
    Vec3d x = solver.eigenvectors().col(2);
    const double skew = skewness(cloud.points, origin, x, frame.deviations[0]);
    if (skew < 0.0) x = -x;
    frame.ambiguous_sign = std::abs(skew) < kMinSkewness;
    frame.ambiguous_order = frame.deviations[1] > kEqualRatio * frame.deviations[0];
    Mat3d axes;
    axes.col(0) = x;
    axes.col(1) = z.cross(x);
    axes.col(2) = z;
    frame.T_cloud_frame.linear() = axes;
    frame.T_cloud_frame.translation() = origin;
    return frame;
}

std::vector<Pose> possible_frames(const PrincipalFrame& frame) {
    const int step = frame.ambiguous_order ? 1 : 2;
    const int last = frame.ambiguous_order ? 3 : (frame.ambiguous_sign ? 2 : 0);
    std::vector<Pose> frames;
    for (int quarter = 0; quarter <= last; quarter += step) {
        Pose turned = frame.T_cloud_frame;
        turned.rotate(Eigen::AngleAxisd(quarter * kPi / 2.0, Eigen::Vector3d::UnitZ()));
        frames.push_back(turned);
    }
    return frames;
}

}  // namespace ostraka
