// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/near_symmetry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "ostraka/mesh/symmetry_poses.hpp"
#include "ostraka/mesh/turns.hpp"
#include "ostraka/registration/icp.hpp"
#include "ostraka/views/viewpoints.hpp"

namespace ostraka {
namespace {

constexpr int kSteps = 36;                // in a full turn: registration gets back from half a step
constexpr std::size_t kSmallest = 3;      // steps: smaller turns map anything nearly onto itself
constexpr std::size_t kQuarter = 9;       // steps: turns of which the axis is known well
constexpr double kSameDirection = 0.95;   // cosine of 18 degrees
constexpr std::size_t kDirections = 162;  // that an axis may have, 16 degrees apart
constexpr std::array kTriedSteps = {3, 6, 9, 12, 18};  // about each of them
constexpr double kShare = 0.75;                        // of the surface that lies on itself again
constexpr double kShareBefore = 0.6;                   // the same before registration
constexpr double kReach = 0.04;   // diameters between the surfaces before registration,
constexpr double kClose = 0.015;  // and after it; or, in sampling distances:
constexpr double kLeastReach = 3.0;
constexpr double kLeastClose = 1.5;
constexpr double kSame = 3.0;       // sampling distances between turns that are the same
constexpr float kMinCosine = 0.7F;  // between normals

class Finder {
  public:
    Finder(const SurfaceField& field, std::span<const Vec3f> points, std::span<const Vec3f> normals)
        : field_(field), points_(points), normals_(normals) {}

    // Share of the surface that lies on it again within `reach`, on the side that faces the same
    // way.
    double share(const Pose& turn, double reach) const {
        const Mat3f R = turn.linear().cast<float>();
        const Vec3f t = turn.translation().cast<float>();
        const auto limit = static_cast<float>(reach);
        std::size_t on = 0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const Vec3f at = R * points_[i] + t;
            const std::uint32_t nearest = field_.nearest(at);
            if (nearest == kNoIndex) continue;
            const Vec3f offset = at - field_.point(nearest);
            const Vec3f& normal = field_.normal(nearest);
            if (std::abs(normal.dot(offset)) > limit || offset.norm() > 3.0F * limit) continue;
            if (normal.dot(R * normals_[i]) >= kMinCosine) ++on;
        }
        return static_cast<double>(on) / static_cast<double>(points_.size());
    }

    Pose registered(const Pose& turn, double reach, double close) const {
        return icp(field_, points_, normals_, turn,
                   {.start_distance = reach, .end_distance = close})
            .T_target_source;
    }

    // The one after which most of the surface lies on itself again, registered; nothing if that is
    // little.
    std::optional<Pose> best(std::span<const Pose> turns, double reach, double close) const {
        double most = kShareBefore;
        std::optional<Pose> found;
        for (const Pose& turn : turns) {
            const double now = share(turn, reach);
            if (now < most) continue;
            most = now;
            found = turn;
        }
        if (found) found = registered(*found, reach, close);
        return found;
    }

  private:
    const SurfaceField& field_;
    std::span<const Vec3f> points_;
    std::span<const Vec3f> normals_;
};

std::vector<Pose> turns_about(const Line& line) {
    std::vector<Pose> turns;
    for (int step = 1; step < kSteps; ++step) {
        turns.push_back(turn_about(line, 2.0 * kPi * step / kSteps));
    }
    return turns;
}

std::vector<Pose> combined(std::vector<Pose> turns, const Pose& with) {
    for (Pose& turn : turns) turn = turn * with;
    turns.push_back(with);
    return turns;
}

// The direction through a point about which turns do best on the whole. A cup as wide as it is
// high, but for its handle, has its principal directions anywhere.
Line likely_axis(const Finder& finder, const Vec3d& point, double reach) {
    Line best{.direction = Vec3d::UnitZ(), .point = point};
    double most = 0.0;
    for (const Vec3d& direction : viewpoints(static_cast<int>(kDirections))) {
        if (direction.z() < 0.0) continue;
        const Line line{.direction = direction, .point = point};
        double sum = 0.0;
        for (const int steps : kTriedSteps) {
            sum += finder.share(turn_about(line, 2.0 * kPi * steps / kSteps), reach);
        }
        if (sum <= most) continue;
        most = sum;
        best = line;
    }
    return best;
}

// The axis of the best turn about a line, of so many steps at least, registered.
std::optional<Line> registered_axis(const Finder& finder, const Line& guess, std::size_t smallest,
                                    double reach, double close) {
    const std::vector<Pose> turns = turns_about(guess);
    const auto large = std::span(turns).subspan(smallest - 1, turns.size() - 2 * (smallest - 1));
    const std::optional<Pose> best = finder.best(large, reach, close);
    if (!best) return std::nullopt;
    double angle = 0.0;
    const Line line = axis_of(*best, angle);
    if (std::abs(line.direction.dot(guess.direction)) < kSameDirection) return std::nullopt;
    return line;
}

// Turns about a line, and half turns across it after them. The line is registered first: what
// tells the turns apart may be less than what a guess of it is off. A wrong guess allows for small
// turns only, which tell the axis roughly; then larger ones tell it better.
std::vector<Pose> candidates(const Finder& finder, const Line& guess, const Vec3d& across,
                             double reach, double close) {
    const std::optional<Line> rough = registered_axis(finder, guess, kSmallest, reach, close);
    if (!rough) return {};
    const Line line = registered_axis(finder, *rough, kQuarter, reach, close).value_or(*rough);
    std::vector<Pose> all = turns_about(line);
    const Pose flip = turn_about({.direction = across, .point = guess.point}, kPi);
    if (const auto half = finder.best(combined(all, flip), reach, close)) {
        const std::vector<Pose> flipped = combined(all, *half);
        all.insert(all.end(), flipped.begin(), flipped.end());
    }
    return all;
}

}  // namespace

std::vector<Pose> near_symmetries(const SurfaceField& field, std::span<const Vec3f> points,
                                  std::span<const Vec3f> normals, const MeshShape& shape,
                                  const Symmetry& exact, double sampling) {
    const Finder finder(field, points, normals);
    const double reach = std::max(kReach * shape.diameter, kLeastReach * sampling);
    const double close = std::max(kClose * shape.diameter, kLeastClose * sampling);
    Vec3d center = Vec3d::Zero();
    for (const Vec3f& point : points) center += point.cast<double>();
    center /= static_cast<double>(points.size());
    std::vector<Pose> kept = {Pose::Identity()};
    const auto keep = [&](Pose turn) {
        if (finder.share(turn, close) < kShare) {
            if (finder.share(turn, reach) < kShareBefore) return;
            turn = finder.registered(turn, reach, close);
            if (finder.share(turn, close) < kShare) return;
        }
        const bool known = std::any_of(kept.begin(), kept.end(), [&](const Pose& other) {
            const PoseDifference apart = symmetric_difference(exact, turn, other);
            return apart.shift + apart.angle * shape.radius < kSame * sampling;
        });
        if (!known) kept.push_back(turn);
    };
    const auto keep_about = [&](const Line& line, const Vec3d& across) {
        for (const Pose& turn : candidates(finder, line, across, reach, close)) keep(turn);
    };
    const Line likely = likely_axis(finder, center, reach);
    keep_about(likely, likely.direction.unitOrthogonal());
    for (int main = 0; main < 3; ++main) {
        keep_about({.direction = shape.axes.col(main), .point = center},
                   shape.axes.col((main + 1) % 3));
    }
    kept.erase(kept.begin());
    return kept;
}

}  // namespace ostraka
