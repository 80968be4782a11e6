// SPDX-License-Identifier: Apache-2.0
// Equivalent poses as in Hodan et al. BOP Challenge 2020 on 6D Object Localization. ECCVW 2020,
// section 2.3, and its toolkit's misc.get_symmetry_transformations().
#include "ostraka/mesh/symmetry_poses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/mesh/symmetry_group.hpp"

namespace ostraka {
namespace {

constexpr double kSameAxis = 1e-6;
constexpr std::size_t kSphereAxes = 3;

// The discrete motions, with the identity in front.
std::vector<Pose> discrete_motions(const Symmetry& symmetry) {
    std::vector<Pose> motions = {Pose::Identity()};
    motions.insert(motions.end(), symmetry.turns.begin(), symmetry.turns.end());
    return motions;
}

double angle_of(const Mat3d& rotation) {
    // Of the sine as well, for a cosine near 1 tells small angles badly.
    const Vec3d twice_sine(rotation(2, 1) - rotation(1, 2), rotation(0, 2) - rotation(2, 0),
                           rotation(1, 0) - rotation(0, 1));
    return std::atan2(twice_sine.norm(), rotation.trace() - 1.0);
}

// The angle of the turn about `axis` that makes trace(matrix * turn) largest: the trace is
// (trace - a) cos + s sin + a with a = axis^T matrix axis, s = the axis dot twice the skew part.
double best_angle(const Mat3d& matrix, const Vec3d& axis) {
    const Vec3d skew(matrix(1, 2) - matrix(2, 1), matrix(2, 0) - matrix(0, 2),
                     matrix(0, 1) - matrix(1, 0));
    const double sine = axis.dot(skew);
    const double cosine = matrix.trace() - axis.dot(matrix * axis);
    return sine == 0.0 && cosine == 0.0 ? 0.0 : std::atan2(sine, cosine);
}

// The axis with most turns about it, and how many turns it has, the identity included.
struct MainAxis {
    Vec3d direction = Vec3d::UnitZ();
    std::size_t order = 1;
};

MainAxis main_axis(const std::vector<Pose>& turns) {
    MainAxis main;
    for (const Pose& turn : turns) {
        const Vec3d direction = Eigen::AngleAxisd(Eigen::Matrix3d(turn.linear())).axis();
        const auto about = std::count_if(turns.begin(), turns.end(), [&](const Pose& other) {
            return (other.linear() * direction - direction).norm() < kSameAxis;
        });
        const std::size_t order = static_cast<std::size_t>(about) + 1;
        if (order > main.order) main = {direction, order};
    }
    main.direction = upward(main.direction);
    return main;
}

std::string axis_text(const Vec3d& axis) {
    const auto rounded = [](double value) { return std::round(value * 1e3) / 1e3 + 0.0; };
    return fmt::format("({:.3g} {:.3g} {:.3g})", rounded(axis.x()), rounded(axis.y()),
                       rounded(axis.z()));
}

}  // namespace

Vec3d symmetry_center(const std::vector<Pose>& turns, const std::vector<ContinuousAxis>& axes) {
    std::vector<Pose> motions = turns;
    for (const ContinuousAxis& axis : axes) {
        const Line line{.direction = axis.direction, .point = axis.point};
        motions.push_back(turn_about(line, 0.5 * kPi));
    }
    return fixed_point(motions);
}

std::vector<Pose> symmetry_motions(const Symmetry& symmetry, int steps) {
    if (steps < 1) throw InvalidInput("equivalent poses: at least one step in a turn is needed");
    std::vector<Pose> motions;
    for (const Pose& discrete : discrete_motions(symmetry)) {
        motions.push_back(discrete);
        for (const ContinuousAxis& axis : symmetry.axes) {
            const Line line{.direction = axis.direction, .point = axis.point};
            for (int k = 1; k < steps; ++k) {
                motions.push_back(turn_about(line, 2.0 * kPi * k / steps) * discrete);
            }
        }
    }
    return motions;
}

std::vector<Pose> equivalent_poses(const Symmetry& symmetry, const Pose& T_scene_model, int steps) {
    std::vector<Pose> poses = symmetry_motions(symmetry, steps);
    for (Pose& pose : poses) pose = T_scene_model * pose;
    return poses;
}

Pose nearest_equivalent_pose(const Symmetry& symmetry, const Pose& T_scene_model,
                             const Pose& T_scene_reference) {
    const Mat3d R_reference_model = T_scene_reference.linear().transpose() * T_scene_model.linear();
    if (symmetry.axes.size() >= kSphereAxes) {
        return T_scene_model * turn_at(symmetry.center, R_reference_model.transpose());
    }
    Pose best = T_scene_model;
    double best_trace = -2.0;
    for (const Pose& discrete : discrete_motions(symmetry)) {
        Pose motion = discrete;
        if (!symmetry.axes.empty()) {
            const ContinuousAxis& axis = symmetry.axes[0];
            // trace(M C D) = trace((D M) C)
            const double angle = best_angle(discrete.linear() * R_reference_model, axis.direction);
            motion = turn_about({.direction = axis.direction, .point = axis.point}, angle) * motion;
        }
        const double trace = (R_reference_model * motion.linear()).trace();
        if (trace > best_trace + 1e-12) {
            best_trace = trace;
            best = T_scene_model * motion;
        }
    }
    return best;
}

PoseDifference symmetric_difference(const Symmetry& symmetry, const Pose& T_scene_a,
                                    const Pose& T_scene_b) {
    const Pose nearest = nearest_equivalent_pose(symmetry, T_scene_a, T_scene_b);
    return {.angle = angle_of(T_scene_b.linear().transpose() * nearest.linear()),
            .shift = (T_scene_a * symmetry.center - T_scene_b * symmetry.center).norm()};
}

std::string symmetry_name(const Symmetry& symmetry) {
    if (symmetry.axes.size() >= kSphereAxes) return "sphere";
    if (!symmetry.axes.empty()) return symmetry.turns.empty() ? "C-infinity" : "D-infinity";
    const std::size_t size = symmetry.turns.size() + 1;
    const std::size_t order = main_axis(symmetry.turns).order;
    if (size == order) return fmt::format("C{}", order);
    if (size == 2 * order) return fmt::format("D{}", order);
    if (size == 12 && order == 3) return "T";
    if (size == 24 && order == 4) return "O";
    if (size == 60 && order == 5) return "I";
    return "other";
}

std::string describe_symmetry(const Symmetry& symmetry) {
    const std::string name = symmetry_name(symmetry);
    if (name == "sphere") return "any turn";
    if (!symmetry.axes.empty()) {
        return "continuous about " + axis_text(symmetry.axes[0].direction) +
               (symmetry.turns.empty() ? "" : ", and half turns across");
    }
    if (symmetry.turns.empty()) return "none";
    if (name == "T") return "the 11 turns of a tetrahedron";
    if (name == "O") return "the 23 turns of a cube";
    if (name == "I") return "the 59 turns of an icosahedron";
    if (name == "other") return fmt::format("{} turns", symmetry.turns.size());
    const MainAxis main = main_axis(symmetry.turns);
    const std::string text = fmt::format("{}-fold about {}", main.order, axis_text(main.direction));
    if (name[0] == 'C') return text;
    return text + fmt::format(", and {} half turns across", main.order);
}

}  // namespace ostraka
