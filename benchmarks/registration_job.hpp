// SPDX-License-Identifier: Apache-2.0
// The job of all registration benchmarks: bring a cloud back onto itself, without normals, from 5
// degrees and 3.6 % of its radius off.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "clouds.hpp"
#include "ostraka/registration/cloud_icp.hpp"

namespace ostraka::bench {

struct RegistrationJob {
    explicit RegistrationJob(const BenchCloud& cloud) : radius(cloud.radius) {
        points.points = cloud.cloud.points;
        points.viewpoint = cloud.cloud.viewpoint;
        const Vec3d center = centroid(points.points);
        guess.translate(Eigen::Vector3d(center + 0.036 * radius * Vec3d(0.6, -0.64, 0.48)));
        guess.rotate(Eigen::AngleAxisd(5.0 * kPi / 180.0, Eigen::Vector3d(0.36, 0.48, 0.8)));
        guess.translate(Eigen::Vector3d(-center));
    }

    /// The points moved by T, which should be the identity.
    std::vector<float> moved(const Pose& T) const {
        std::vector<float> flat;
        for (const Vec3f& p : points.points) {
            const Vec3d q = T * p.cast<double>();
            for (int axis = 0; axis < 3; ++axis) flat.push_back(static_cast<float>(q[axis]));
        }
        return flat;
    }
    /// Largest error of a point over the radius.
    double error(const Pose& T) const {
        double worst = 0.0;
        for (const Vec3f& p : points.points) {
            worst = std::max(worst, (T * p.cast<double>() - p.cast<double>()).norm());
        }
        return worst / radius;
    }
    std::string note() const {
        return fmt::format("error / radius: ours {:.0e} ({} steps), peer {:.0e}",
                           error(ours.T_target_source), ours.iterations, error(peer));
    }

    PointCloud points;
    double radius = 0.0;
    Pose guess = Pose::Identity();
    IcpResult ours;
    Pose peer = Pose::Identity();
};

}  // namespace ostraka::bench
