// SPDX-License-Identifier: Apache-2.0
#include "ostraka/mesh/symmetry.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "ostraka/base/error.hpp"
#include "ostraka/mesh/shape.hpp"
#include "ostraka/mesh/surface_samples.hpp"
#include "ostraka/mesh/symmetry_axes.hpp"
#include "ostraka/mesh/symmetry_group.hpp"
#include "ostraka/mesh/symmetry_surface.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kMinPoints = 100;
constexpr std::size_t kQuickSamples = 160;  // tell most turns that are no symmetry
constexpr double kQuickOutliers = 0.03;
constexpr std::size_t kFitSamples = 200;      // for a first registration
constexpr std::size_t kPolishSamples = 1000;  // for the axes that are reported
constexpr std::size_t kTestSamples = 1000;    // for each of many turns; a few are tested on all
constexpr double kTestOutliers = 0.002;       // above the setting: fewer samples, more chance
constexpr int kTries = 3;                     // registrations of a candidate
constexpr double kSlid = 0.75;                // of the angle guessed: less is another turn
constexpr double kSlidAxis = 0.966;           // cosine of 15 degrees
constexpr double kParallel = 0.9986;          // cosine of 3 degrees
constexpr double kAcross = 0.0524;            // cosine of 87 degrees
constexpr double kAcrossStep = 0.025;         // radians between half turns tried across an axis
constexpr int kPoolPerSample = 8;             // points drawn on a mesh for a sample

// An axis that is there.
struct FoundAxis {
    Line line;
    int order = 1;  // 0 if continuous
};

class Finder {
  public:
    Finder(const SymmetrySurface& surface, const SymmetrySettings& settings)
        : surface_(surface), settings_(settings) {}

    Symmetry find() const;

  private:
    bool quick(const Pose& turn) const {
        return surface_.lies_on_itself(turn, kQuickSamples,
                                       settings_.tolerance + SymmetrySurface::kLooseness,
                                       settings_.outliers + kQuickOutliers);
    }
    bool test(const Pose& turn) const {
        return surface_.lies_on_itself(turn, kTestSamples, settings_.tolerance,
                                       settings_.outliers + kTestOutliers);
    }
    // On all samples, and the other way around, too: the surface on the turned one.
    bool certain(const Pose& turn) const {
        const std::size_t all = surface_.size();
        return surface_.lies_on_itself(turn, all, settings_.tolerance, settings_.outliers) &&
               surface_.lies_on_itself(turn.inverse(), all, settings_.tolerance,
                                       settings_.outliers);
    }
    bool continuous(const Line& line) const;
    bool has_order(const Line& line, int order) const;
    int order_about(const Line& line) const;
    std::optional<Line> registered(const Pose& guess) const;
    std::optional<FoundAxis> examine(const Vec3d& direction) const;
    std::optional<Line> half_turn_across(const FoundAxis& main) const;
    bool all_hold(std::span<const Mat3d> group, const Vec3d& center) const;
    bool try_polyhedral(const std::vector<FoundAxis>& axes, Symmetry& symmetry) const;
    Symmetry about_one_axis(const FoundAxis& main) const;
    Symmetry round(const FoundAxis& main) const;

    const SymmetrySurface& surface_;
    const SymmetrySettings& settings_;
};

bool Finder::continuous(const Line& line) const {
    // Multiples of two irrational parts of a turn: for every order up to 360, at least one of these
    // turns is between a third and two thirds of a step off.
    constexpr std::array<double, 2> kParts = {0.6180339887498949, 0.4142135623730951};
    for (int k = 1; k <= 8; ++k) {
        for (const double part : kParts) {
            if (!test(turn_about(line, 2.0 * kPi * part * k))) return false;
        }
    }
    return certain(turn_about(line, 2.0 * kPi * kParts[0]));
}

bool Finder::has_order(const Line& line, int order) const {
    const auto turn = [&](int k) { return turn_about(line, 2.0 * kPi * k / order); };
    // In long strides, as small turns are nearly symmetries of anything, and half turns of much.
    int stride = std::max(1, static_cast<int>(0.382 * order));
    while (std::gcd(stride, order) != 1) ++stride;
    for (int k = stride % order; k != 0; k = (k + stride) % order) {
        if (!test(turn(k))) return false;
    }
    return certain(turn(1)) && certain(turn(order / 2));
}

// 0 if continuous, 1 if there is no symmetry.
int Finder::order_about(const Line& line) const {
    if (continuous(line)) return 0;
    int order = settings_.max_order;
    while (order > 1 && !has_order(line, order)) --order;
    return order;
}

// The axis of a symmetry near the guess, if there is one.
std::optional<Line> Finder::registered(const Pose& guess) const {
    double guessed = 0.0;
    const Line unchanged = axis_of(guess, guessed);
    Pose motion = surface_.refined(guess, kFitSamples);
    double angle = 0.0;
    const Line moved = axis_of(motion, angle);
    // A turn of a smooth surface may slide to another, or back to no turn at all.
    const bool slid =
        angle < kSlid * guessed || std::abs(moved.direction.dot(unchanged.direction)) < kSlidAxis;
    if (slid || !test(motion)) {
        return test(guess) ? std::optional(unchanged) : std::nullopt;
    }
    motion = surface_.refined(motion, kPolishSamples);
    return axis_of(motion, angle);
}

std::optional<FoundAxis> Finder::examine(const Vec3d& direction) const {
    const Line guess{.direction = direction};
    int tries = 0;
    for (int order = 2; order <= settings_.max_order && tries < kTries; ++order) {
        bool prime = true;
        for (int k = 2; k * k <= order; ++k) prime = prime && order % k != 0;
        if (!prime || !quick(turn_about(guess, 2.0 * kPi / order))) continue;
        ++tries;
        const std::optional<Line> line = registered(turn_about(guess, 2.0 * kPi / order));
        if (!line) continue;
        FoundAxis found{.line = *line, .order = order_about(*line)};
        if (found.order != 1) return found;
    }
    return std::nullopt;
}

// A dihedral group has exactly one half turn within half of a step.
std::optional<Line> Finder::half_turn_across(const FoundAxis& main) const {
    const double range = main.order == 0 ? 0.0 : kPi / main.order;
    const int steps = main.order == 0 ? 1 : std::max(8, int(std::ceil(range / kAcrossStep)));
    const Vec3d side = main.line.direction.unitOrthogonal();
    for (int i = 0; i < steps; ++i) {
        const Vec3d axis = rotation_about(main.line.direction, range * i / steps) * side;
        // The centroid is on the axis, unless the surface is not even.
        const Pose guess = turn_about({.direction = axis, .point = main.line.point}, kPi);
        if (!quick(guess)) continue;
        const std::optional<Line> line = registered(guess);
        if (line && std::abs(line->direction.dot(main.line.direction)) < kAcross) return line;
    }
    return std::nullopt;
}

bool Finder::all_hold(std::span<const Mat3d> group, const Vec3d& center) const {
    return std::all_of(group.begin(), group.end(),
                       [&](const Mat3d& turn) { return test(turn_at(center, turn)); });
}

void set_turns(Symmetry& symmetry, const std::vector<Mat3d>& group) {
    for (std::size_t i = 1; i < group.size(); ++i) {
        symmetry.turns.push_back(turn_at(symmetry.center, group[i]));
    }
}

// Two axes of order 3 or more that cross make a tetrahedron's, cube's or icosahedron's group.
bool Finder::try_polyhedral(const std::vector<FoundAxis>& axes, Symmetry& symmetry) const {
    std::size_t largest = symmetry.turns.size();  // without the identity
    const FoundAxis& last = axes.back();
    for (std::size_t i = 0; i + 1 < axes.size(); ++i) {
        if (axes[i].order < 3 && last.order < 3) continue;
        const std::array<Pose, 2> generators = {turn_about(axes[i].line, 2.0 * kPi / axes[i].order),
                                                turn_about(last.line, 2.0 * kPi / last.order)};
        const std::vector<Mat3d> group =
            polyhedral_group(generators[0].linear(), generators[1].linear());
        if (group.size() <= largest + 1) continue;
        const Vec3d center = fixed_point(generators);
        if (!all_hold(group, center)) continue;
        largest = group.size() - 1;
        symmetry = {.center = center};
        set_turns(symmetry, group);
    }
    return largest >= 23;
}

Symmetry Finder::about_one_axis(const FoundAxis& main) const {
    Symmetry symmetry;
    symmetry.center = main.line.point;
    const std::optional<Line> across = half_turn_across(main);
    if (across) {
        const std::vector<Mat3d> group =
            dihedral_group(main.line.direction, across->direction, main.order);
        const std::array<Pose, 2> generators = {turn_about(main.line, 2.0 * kPi / main.order),
                                                turn_about(*across, kPi)};
        const Vec3d center = fixed_point(generators);
        if (all_hold(group, center) &&
            certain(turn_at(center, group[static_cast<std::size_t>(main.order)]))) {
            symmetry.center = center;
            set_turns(symmetry, group);
            return symmetry;
        }
    }
    set_turns(symmetry, cyclic_group(main.line.direction, main.order));
    return symmetry;
}

// With a continuous axis: anything that turns, a thing that may be turned over, or a sphere.
Symmetry Finder::round(const FoundAxis& main) const {
    Symmetry symmetry;
    symmetry.center = main.line.point;
    symmetry.axes = {{.direction = main.line.direction, .point = main.line.point}};
    const std::optional<Line> across = half_turn_across(main);
    if (!across) return symmetry;
    const std::array<Pose, 2> generators = {turn_about(main.line, 0.5 * kPi),
                                            turn_about(*across, kPi)};
    const Vec3d center = fixed_point(generators);
    const Vec3d& up = main.line.direction;
    const Vec3d side = (across->direction - up.dot(across->direction) * up).normalized();
    if (!certain(turn_at(center, rotation_about(side, kPi)))) return symmetry;
    symmetry.center = center;
    symmetry.axes[0].point = center;
    if (continuous({.direction = side, .point = center})) {
        symmetry.axes.clear();
        for (int k = 0; k < 3; ++k) symmetry.axes.push_back({Vec3d::Unit(k), center});
        return symmetry;
    }
    set_turns(symmetry, {Mat3d::Identity(), 2.0 * side * side.transpose() - Mat3d::Identity()});
    return symmetry;
}

Symmetry Finder::find() const {
    std::vector<FoundAxis> axes;
    Symmetry polyhedral;
    for (const Vec3d& direction : candidate_axes(surface_.points(), surface_.normals())) {
        const bool known = std::any_of(axes.begin(), axes.end(), [&](const FoundAxis& axis) {
            return std::abs(axis.line.direction.dot(direction)) > kParallel;
        });
        if (known) continue;
        const std::optional<FoundAxis> found = examine(direction);
        if (!found) continue;
        if (found->order == 0) return round(*found);
        axes.push_back(*found);
        // With an order above 5 there is nothing else but half turns across it.
        if (found->order > 5) return about_one_axis(*found);
        if (try_polyhedral(axes, polyhedral)) break;
    }
    if (!polyhedral.turns.empty()) return polyhedral;
    if (axes.empty()) return {};
    const auto main =
        std::max_element(axes.begin(), axes.end(),
                         [](const FoundAxis& a, const FoundAxis& b) { return a.order < b.order; });
    return about_one_axis(*main);
}

// From the surface's frame to the model's, in the documented order.
Symmetry in_model_frame(const Symmetry& found, const SymmetrySurface& surface, double diameter) {
    Symmetry symmetry;
    symmetry.center = surface.origin() + diameter * found.center;
    for (const ContinuousAxis& axis : found.axes) {
        symmetry.axes.push_back({upward(axis.direction), symmetry.center});
    }
    struct Keyed {
        Mat3d turn;
        std::array<double, 5> key;  // minus the axis's order, the angle, the axis
    };
    std::vector<Keyed> keyed;
    for (const Pose& turn : found.turns) {
        double angle = 0.0;
        const Line line = axis_of(turn, angle);
        const auto about =
            std::count_if(found.turns.begin(), found.turns.end(), [&](const Pose& other) {
                return (other.linear() * line.direction - line.direction).norm() < 1e-6;
            });
        const Vec3d up = upward(line.direction);
        const bool flipped = up.dot(line.direction) < 0.0;
        // A half turn's angle is the same either way.
        const double turned = flipped && angle < kPi - 1e-6 ? 2.0 * kPi - angle : angle;
        const auto rounded = [](double value) { return std::round(value * 1e6); };
        keyed.push_back({turn.linear(),
                         {-static_cast<double>(about), rounded(-up.z()), rounded(-up.y()),
                          rounded(-up.x()), rounded(turned)}});
    }
    std::stable_sort(keyed.begin(), keyed.end(),
                     [](const Keyed& a, const Keyed& b) { return a.key < b.key; });
    for (const Keyed& k : keyed) symmetry.turns.push_back(turn_at(symmetry.center, k.turn));
    return symmetry;
}

void check(const SymmetrySettings& settings) {
    if (!(settings.tolerance > 0.0 && settings.tolerance <= 0.05)) {
        throw InvalidInput("symmetry: the tolerance must be above 0 and at most 0.05");
    }
    if (!(settings.outliers >= 0.0 && settings.outliers <= 0.05)) {
        throw InvalidInput("symmetry: the share of outliers must be from 0 to 0.05");
    }
    if (settings.max_order < 2 || settings.max_order > 360) {
        throw InvalidInput("symmetry: the highest order must be from 2 to 360");
    }
    if (settings.samples < 500 || settings.samples > 100'000) {
        throw InvalidInput("symmetry: the number of samples must be from 500 to 100000");
    }
}

void check(const PointCloud& surface, double diameter) {
    if (surface.size() < kMinPoints) {
        throw InvalidInput("symmetry: the surface has fewer than 100 valid points");
    }
    Vec3f low = surface.points[0];
    Vec3f high = low;
    for (const Vec3f& point : surface.points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    if ((high - low).cast<double>().maxCoeff() > 1.02 * diameter) {
        throw InvalidInput("symmetry: the surface is larger than the diameter");
    }
}

// @param spacing  of the samples, in diameters: a guess.
Symmetry find_from(const PointCloud& surface, double diameter, double spacing,
                   const SymmetrySettings& settings) {
    const SymmetrySurface samples(surface.points, surface.normals, diameter, settings.tolerance,
                                  settings.samples, spacing);
    return in_model_frame(Finder(samples, settings).find(), samples, diameter);
}

}  // namespace

Symmetry find_symmetry(const PointCloud& surface, double diameter,
                       const SymmetrySettings& settings) {
    check(settings);
    check(surface);
    if (surface.normals.empty()) throw InvalidInput("symmetry: the surface has no normals");
    if (!(diameter > 0.0) || !std::isfinite(diameter)) {
        throw InvalidInput("symmetry: the diameter must be positive");
    }
    const PointCloud valid = remove_invalid(surface);
    check(valid, diameter);
    return find_from(valid, diameter, 0.02, settings);
}

Symmetry find_symmetry(const TriangleMesh& mesh, const SymmetrySettings& settings) {
    check(settings);
    SurfaceSamples samples =
        sample_uniformly(mesh, static_cast<std::size_t>(settings.samples) * kPoolPerSample);
    PointCloud surface;
    surface.points = std::move(samples.points);
    surface.normals = std::move(samples.normals);
    const double diameter = measure(mesh).diameter;
    // Samples are packed to about 0.7 over the square of their spacing.
    const double spacing = std::sqrt(surface_area(mesh) / (0.7 * settings.samples)) / diameter;
    return find_from(surface, diameter, std::min(spacing, 0.1), settings);
}

}  // namespace ostraka
