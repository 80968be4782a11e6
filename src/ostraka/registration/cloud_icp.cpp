// SPDX-License-Identifier: Apache-2.0
// Cost, one thread, of two clouds of 6,000 points: the target's normals (two thirds of the whole)
// and columns, six to eight steps with 500 points, one or two with all. A step's floor is its sums,
// 27 products a point; finding the partners takes five times as long, although each search starts
// from the partner of the step before.
#include "ostraka/registration/cloud_icp.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/point_columns.hpp"
#include "ostraka/registration/plane_pairs.hpp"

namespace ostraka {

struct IcpTarget::Implementation {
    PointColumns columns;
    std::vector<Vec3f> normals;  // by slot; NaN: never paired
};

namespace {

constexpr int kLeastPairs = 6;
constexpr double kFreeRatio = 1e-7;     // of the largest eigenvalue: below it a direction is free
constexpr double kCoarseEnough = 1e-5;  // a step's share of the radius after which all points count
constexpr double kPointsPerColumn = 4.0;

// One alignment's state between steps.
class Alignment {
  public:
    Alignment(const IcpTarget::Implementation& target, std::span<const Vec3f> source,
              const CloudIcpSettings& settings)
        : target_(target), source_(source), partner_(source.size(), kNoIndex) {
        const double limit = settings.max_distance;
        limit_ = limit > 0.0 ? static_cast<float>(limit * limit)
                             : std::numeric_limits<float>::infinity();
        center_ = centroid(source);
        for (const Vec3f& point : source) {
            radius_ = std::max(radius_, (point.cast<double>() - center_).norm());
        }
        if (!(radius_ > 0.0)) radius_ = 1.0;
    }

    double radius() const { return radius_; }

    // One Gauss-Newton step with every `stride`-th point.
    // @return how far the step moves a point at the radius at most; < 0 with too few pairs.
    double step(std::size_t stride, IcpResult& result) {
        const std::size_t count = (source_.size() + stride - 1) / stride;
        std::vector<PlaneSums> chunks((count + PlanePairs::kMost - 1) / PlanePairs::kMost);
        const Vec3d pivot = result.T_target_source * center_;
        parallel_for(chunks.size(), [&](std::size_t c) {
            const std::size_t last = std::min(count, (c + 1) * PlanePairs::kMost);
            chunks[c] = chunk(c * PlanePairs::kMost, last, stride, result.T_target_source, pivot);
        });
        PlaneSums all;
        for (const PlaneSums& chunk : chunks) all += chunk;
        result.inliers = static_cast<int>(all.pairs());
        if (result.inliers < kLeastPairs) return -1.0;
        result.rms = std::sqrt(all.squares() / result.inliers);
        return apply(all, pivot, result.T_target_source);
    }

  private:
    PlaneSums chunk(std::size_t first, std::size_t last, std::size_t stride,
                    const Pose& T_target_source, const Vec3d& pivot) {
        PlanePairs pairs;
        const Mat3d R = T_target_source.linear();
        const Vec3d t = T_target_source.translation();
        const double scale = 1.0 / radius_;
        const PointColumns& columns = target_.columns;
        for (std::size_t n = first; n < last; ++n) {
            const std::size_t i = n * stride;
            const Vec3d moved = R * source_[i].cast<double>() + t;
            const Vec3f query = moved.cast<float>();
            float squared = limit_;
            std::uint32_t slot = partner_[i];
            if (slot != kNoIndex) {
                const Vec3f offset = query - point(columns, slot);
                squared = offset.squaredNorm();
                // Too far now, but another may be near enough.
                if (!(squared < limit_)) {
                    squared = limit_;
                    slot = kNoIndex;
                }
            }
            slot = columns.nearest_slot(query, slot, squared);
            partner_[i] = slot;
            if (slot == kNoIndex) continue;
            const Vec3d normal = target_.normals[slot].cast<double>();
            if (!(normal.squaredNorm() > 0.5)) continue;  // also NaN
            const Vec3d turn = (moved - pivot).cross(normal) * scale;
            pairs.add(turn, normal, normal.dot(moved - point(columns, slot).cast<double>()));
        }
        return pairs.take();
    }

    static Vec3f point(const PointColumns& columns, std::uint32_t slot) {
        return {columns.coordinate(0)[slot], columns.coordinate(1)[slot],
                columns.coordinate(2)[slot]};
    }

    double apply(const PlaneSums& all, const Vec3d& pivot, Pose& T_target_source) const {
        const Eigen::SelfAdjointEigenSolver<Mat6d> solver(all.left());
        const Vec6d right = all.right();
        const double least = kFreeRatio * solver.eigenvalues()[5];
        Vec6d step = Vec6d::Zero();
        for (Eigen::Index k = 0; k < 6; ++k) {
            if (!(solver.eigenvalues()[k] > least)) continue;
            const Vec6d direction = solver.eigenvectors().col(k);
            step += direction * (direction.dot(right) / solver.eigenvalues()[k]);
        }
        const Vec3d turn = step.head<3>() / radius_;
        const Vec3d shift = step.tail<3>();
        T_target_source = step_about(pivot, turn, shift) * T_target_source;
        return turn.norm() * radius_ + shift.norm();
    }

    const IcpTarget::Implementation& target_;
    std::span<const Vec3f> source_;
    std::vector<std::uint32_t> partner_;  // slot of each source point's partner in its last step
    float limit_;                         // largest squared distance of a pair
    Vec3d center_ = Vec3d::Zero();        // of the source
    double radius_ = 0.0;                 // of the source around it
};

void check(const CloudIcpSettings& settings) {
    if (settings.iterations < 1 || settings.coarse_points < kLeastPairs) {
        throw InvalidInput("ICP: needs at least 1 iteration and 6 coarse points");
    }
    if (!(settings.convergence > 0.0)) throw InvalidInput("ICP: convergence must be positive");
    if (!(settings.max_distance >= 0.0)) throw InvalidInput("ICP: max_distance is negative");
}

// A column's side that gives a few points a column on a surface.
double column_side(std::span<const Vec3f> points) {
    Vec3f low = points.front();
    Vec3f high = points.front();
    for (const Vec3f& point : points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    std::array<double, 3> extent{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<Eigen::Index>(axis);
        extent[axis] = double{high[a]} - double{low[a]};
    }
    std::sort(extent.begin(), extent.end());
    const double columns = static_cast<double>(points.size()) / kPointsPerColumn;
    const double side = std::max(std::sqrt(extent[2] * extent[1] / columns), extent[2] / columns);
    return side > 0.0 ? side : 1.0;
}

}  // namespace

IcpTarget::IcpTarget(const PointCloud& cloud, const CloudIcpSettings& settings) {
    ostraka::check(cloud);
    if (cloud.empty()) throw InvalidInput("ICP: the target has no points");
    PointColumns columns(cloud.points, column_side(cloud.points));
    std::vector<Vec3f> estimated;
    if (cloud.normals.empty()) {
        estimated = estimate_normals(cloud, {.neighbors = settings.neighbors});
    }
    const std::vector<Vec3f>& normals = cloud.normals.empty() ? estimated : cloud.normals;
    std::vector<Vec3f> by_slot(cloud.size());
    for (std::size_t s = 0; s < cloud.size(); ++s) by_slot[s] = normals[columns.order()[s]];
    implementation_ =
        std::make_unique<Implementation>(Implementation{std::move(columns), std::move(by_slot)});
}
IcpTarget::~IcpTarget() = default;
IcpTarget::IcpTarget(IcpTarget&&) noexcept = default;
IcpTarget& IcpTarget::operator=(IcpTarget&&) noexcept = default;

IcpResult align_clouds(const IcpTarget& target, std::span<const Vec3f> source,
                       const Pose& T_target_source, const CloudIcpSettings& settings) {
    check(settings);
    IcpResult result;
    result.T_target_source = T_target_source;
    if (source.empty()) return result;
    Alignment alignment(target.implementation(), source, settings);
    const double enough = settings.convergence * alignment.radius();
    std::size_t stride =
        std::max<std::size_t>(1, source.size() / static_cast<std::size_t>(settings.coarse_points));
    for (int i = 0; i < settings.iterations; ++i) {
        // The last iterations see all points, even if the coarse ones have not settled.
        if (i >= settings.iterations / 2) stride = 1;
        const double moved = alignment.step(stride, result);
        if (moved < 0.0) {
            result.T_target_source = T_target_source;
            return result;
        }
        result.iterations = i + 1;
        result.converged = stride == 1 && moved < enough;
        if (result.converged) return result;
        if (moved < kCoarseEnough * alignment.radius()) stride = 1;
    }
    return result;
}

IcpResult align_clouds(const PointCloud& target, const PointCloud& source,
                       const Pose& T_target_source, const CloudIcpSettings& settings) {
    return align_clouds(IcpTarget(target, settings), source.points, T_target_source, settings);
}

}  // namespace ostraka
