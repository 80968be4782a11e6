// SPDX-License-Identifier: Apache-2.0
#include "ostraka/cloud/planes.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kScoredPoints = 4000;  // at most so many points judge each trial
constexpr int kRefinements = 4;

struct Candidate {
    Vec3f normal = Vec3f::Zero();
    float offset = 0.0F;
};

bool on_plane(const PointCloud& cloud, std::size_t i, const Candidate& plane, float tolerance,
              float min_cosine) {
    const float distance = plane.normal.dot(cloud.points[i]) - plane.offset;
    return std::abs(distance) < tolerance &&
           std::abs(plane.normal.dot(cloud.normals[i])) > min_cosine;
}

// The plane through three random points; a zero normal where they lie on a line.
Candidate draw(const PointCloud& cloud, Random random) {
    const auto count = static_cast<std::uint32_t>(cloud.size());
    const Vec3f a = cloud.points[random.below(count)];
    const Vec3f b = cloud.points[random.below(count)];
    const Vec3f c = cloud.points[random.below(count)];
    const Vec3f cross = (b - a).cross(c - a);
    const float length = cross.norm();
    if (!(length > 0.0F)) return {};
    Candidate plane;
    plane.normal = cross / length;
    plane.offset = plane.normal.dot(a);
    return plane;
}

std::vector<std::uint32_t> inliers_of(const PointCloud& cloud, const Candidate& plane,
                                      float tolerance, float min_cosine) {
    std::vector<std::uint32_t> inliers;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        if (on_plane(cloud, i, plane, tolerance, min_cosine)) inliers.push_back(i);
    }
    return inliers;
}

Candidate fit(const PointCloud& cloud, const std::vector<std::uint32_t>& inliers) {
    Vec3d mean = Vec3d::Zero();
    for (const std::uint32_t i : inliers) mean += cloud.points[i].cast<double>();
    mean /= static_cast<double>(inliers.size());
    Mat3d scatter = Mat3d::Zero();
    for (const std::uint32_t i : inliers) {
        const Vec3d offset = cloud.points[i].cast<double>() - mean;
        scatter += offset * offset.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
    const Vec3d normal = solver.eigenvectors().col(0);
    return {normal.cast<float>(), static_cast<float>(normal.dot(mean))};
}

}  // namespace

std::optional<Plane> find_plane(const PointCloud& cloud, std::size_t min_inliers,
                                const PlaneSettings& settings) {
    if (cloud.normals.size() != cloud.size()) throw InvalidInput("planes: the cloud needs normals");
    if (settings.trials < 1) throw InvalidInput("planes: trials must be at least 1");
    if (cloud.size() < 3) return std::nullopt;
    const auto tolerance = static_cast<float>(settings.tolerance);
    const auto min_cosine = static_cast<float>(std::cos(settings.max_angle));
    const std::size_t stride = 1 + cloud.size() / kScoredPoints;
    std::vector<Candidate> candidates(static_cast<std::size_t>(settings.trials));
    std::vector<std::size_t> votes(candidates.size(), 0);
    parallel_for(candidates.size(), [&](std::size_t trial) {
        candidates[trial] = draw(cloud, Random(settings.seed, trial));
        for (std::size_t i = 0; i < cloud.size(); i += stride) {
            if (on_plane(cloud, i, candidates[trial], tolerance, min_cosine)) ++votes[trial];
        }
    });
    std::size_t best = 0;
    for (std::size_t trial = 1; trial < votes.size(); ++trial) {
        if (votes[trial] > votes[best]) best = trial;
    }
    Candidate plane = candidates[best];
    std::vector<std::uint32_t> inliers = inliers_of(cloud, plane, tolerance, min_cosine);
    for (int i = 0; i < kRefinements && inliers.size() >= 3; ++i) {
        plane = fit(cloud, inliers);
        inliers = inliers_of(cloud, plane, tolerance, min_cosine);
    }
    if (inliers.size() < std::max<std::size_t>(3, min_inliers)) return std::nullopt;
    Plane result{plane.normal.cast<double>(), double{plane.offset}, std::move(inliers)};
    if (result.normal.dot(cloud.viewpoint.cast<double>()) < result.offset) {
        result.normal = -result.normal;
        result.offset = -result.offset;
    }
    return result;
}

}  // namespace ostraka
