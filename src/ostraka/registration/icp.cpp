// SPDX-License-Identifier: Apache-2.0
#include "ostraka/registration/icp.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/registration/plane_pairs.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kBatch = 64;  // points whose partners are fetched together
static_assert(PlanePairs::kMost % kBatch == 0);

// The pairs of one step. What a point needs of memory is fetched while those before it are
// computed: alone each would wait for it twice.
class Matcher {
  public:
    Matcher(const SurfaceField& target, std::span<const Vec3f> source,
            std::span<const Vec3f> source_normals, const IcpSettings& settings)
        : target_(target),
          source_(source),
          source_normals_(source_normals),
          cosine_(static_cast<float>(settings.min_cosine)) {}

    // Sums for a small turn about `pivot` and a shift.
    PlaneSums match(const Pose& T_target_source, const Vec3d& pivot, double distance) {
        R_ = T_target_source.linear().cast<float>();
        t_ = T_target_source.translation().cast<float>();
        squares_ = 0.0;
        PlaneSums sums;
        for (std::size_t first = 0; first < source_.size(); first += kBatch) {
            add_batch(first, std::min(kBatch, source_.size() - first), pivot, distance);
            if (pairs_.size() + kBatch > PlanePairs::kMost) sums += pairs_.take();
        }
        sums += pairs_.take();
        return sums;
    }
    // Of the plane distances of the last match(), without weights.
    double squares() const { return squares_; }

  private:
    void add_batch(std::size_t first, std::size_t count, const Vec3d& pivot, double distance) {
        std::array<Vec3f, kBatch> moved;
        std::array<std::uint32_t, kBatch> partner;
        for (std::size_t i = 0; i < count; ++i) {
            moved[i] = R_ * source_[first + i] + t_;
            partner[i] = target_.cell_of(moved[i]);
            target_.fetch_cell(partner[i]);
        }
        for (std::size_t i = 0; i < count; ++i) {
            partner[i] = target_.nearest_in(partner[i]);
            target_.fetch(partner[i]);
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (partner[i] != kNoIndex) {
                add(moved[i], R_ * source_normals_[first + i], partner[i], pivot, distance);
            }
        }
    }
    void add(const Vec3f& moved, const Vec3f& turned, std::uint32_t partner, const Vec3d& pivot,
             double distance) {
        const auto limit = static_cast<float>(distance);
        const Vec3f& normal = target_.normal(partner);
        const Vec3f offset = moved - target_.point(partner);
        if (offset.squaredNorm() > limit * limit || normal.dot(turned) < cosine_) return;
        const double residual = double{normal.dot(offset)};
        const double ratio = residual / distance;
        const double root = 1.0 - ratio * ratio;  // of Tukey's weight
        const Vec3d n = normal.cast<double>();
        const Vec3d turn = (moved.cast<double>() - pivot).cross(n);
        pairs_.add(root * turn, root * n, root * residual);
        squares_ += residual * residual;
    }

    const SurfaceField& target_;
    std::span<const Vec3f> source_;
    std::span<const Vec3f> source_normals_;
    float cosine_;
    Mat3f R_;
    Vec3f t_;
    PlanePairs pairs_;
    double squares_ = 0.0;
};

}  // namespace

IcpResult icp(const SurfaceField& target, std::span<const Vec3f> source,
              std::span<const Vec3f> source_normals, const Pose& T_target_source,
              const IcpSettings& settings) {
    if (source.size() != source_normals.size()) throw InvalidInput("ICP: normals are missing");
    if (!(settings.start_distance > 0.0) || !(settings.end_distance > 0.0)) {
        throw InvalidInput("ICP: start_distance and end_distance must be positive");
    }
    IcpResult result;
    result.T_target_source = T_target_source;
    if (source.empty()) return result;
    const Vec3d source_center = centroid(source);
    double radius = 0.0;
    for (const Vec3f& point : source) {
        radius = std::max(radius, (point.cast<double>() - source_center).norm());
    }
    const double shrink =
        std::pow(settings.end_distance / settings.start_distance, 2.0 / settings.iterations);
    double distance = settings.start_distance;
    Matcher matcher(target, source, source_normals, settings);
    for (int i = 0; i < settings.iterations; ++i) {
        const Vec3d pivot = result.T_target_source * source_center;
        const PlaneSums sums = matcher.match(result.T_target_source, pivot, distance);
        const auto pairs = static_cast<double>(sums.pairs());
        result.inliers = static_cast<int>(sums.pairs());
        if (sums.pairs() < 6) return result;
        result.rms = std::sqrt(matcher.squares() / pairs);
        // A little damping keeps what a plane or a sphere leaves free from drifting.
        Vec6d damping = Vec6d::Constant(1e-6 * pairs);
        damping.head<3>() *= radius * radius;
        Mat6d left = sums.left();
        left.diagonal() += damping;
        const Vec6d step = left.ldlt().solve(sums.right());
        const Vec3d turn = step.head<3>();
        const Vec3d shift = step.tail<3>();
        result.T_target_source = step_about(pivot, turn, shift) * result.T_target_source;
        result.iterations = i + 1;
        const double moved = turn.norm() * radius + shift.norm();
        const bool finest = distance <= settings.end_distance;
        if (finest && moved < settings.convergence * settings.end_distance) {
            result.converged = true;
            return result;
        }
        distance = std::max(settings.end_distance, distance * shrink);
    }
    return result;
}

}  // namespace ostraka
