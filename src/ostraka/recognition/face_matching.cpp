// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/face_matching.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/segmentation/plane_pieces.hpp"

namespace ostraka {
namespace {

constexpr int kOutlineDirections = 16;
constexpr double kLeastTurn = 0.35;   // radians between the normals of two faces that fix a turn
constexpr double kAngleSlack = 0.12;  // radians that the angle of two faces may differ

struct Interval {
    double low = 0.0;
    double high = 0.0;
    double length() const { return high - low; }
};

Interval shadow(const FlatFace& face, const Vec3d& direction) {
    Interval interval{direction.dot(face.outline[0]), direction.dot(face.outline[0])};
    for (const Vec3d& corner : face.outline) {
        const double at = direction.dot(corner);
        interval.low = std::min(interval.low, at);
        interval.high = std::max(interval.high, at);
    }
    return interval;
}

// By how much `whole` may be shifted to contain `part`.
Interval shifts(const Interval& part, const Interval& whole, double slack) {
    return {part.high - whole.high - slack, part.low - whole.low + slack};
}

// Where one end of the part is an end of the whole; one place if both are, about.
std::vector<double> at_ends(const Interval& allowed, double slack) {
    if (allowed.length() < 4.0 * slack) return {0.5 * (allowed.low + allowed.high)};
    return {allowed.low + slack, allowed.high - slack};
}

double share(const Interval& part, const Interval& whole) {
    return std::min(1.0, part.length() / std::max(whole.length(), 1e-12));
}

struct Guess {
    Pose T_scene_model = Pose::Identity();
    double filled = 0.0;  // share of the faces that the scan fills
};

class FaceMatcher {
  public:
    FaceMatcher(std::span<const FlatFace> model, double slack) : model_(model), slack_(slack) {}

    void match_one(const FlatFace& seen, const FlatFace& face);
    void match_two(const FlatFace& seen, const FlatFace& seen2);
    std::vector<Guess> guesses;

  private:
    void match_two(const FlatFace& seen, const FlatFace& seen2, const FlatFace& face,
                   const FlatFace& face2);
    void add(const Mat3d& R, const Vec3d& t, double filled) {
        Guess guess;
        guess.T_scene_model.linear() = R;
        guess.T_scene_model.translation() = t;
        guess.filled = filled;
        guesses.push_back(guess);
    }

    std::span<const FlatFace> model_;
    double slack_;
};

// Rectangle on rectangle, in each of four turns.
void FaceMatcher::match_one(const FlatFace& seen, const FlatFace& face) {
    for (int quarter = 0; quarter < 4; ++quarter) {
        const Mat3d turn =
            Eigen::AngleAxisd(quarter * kPi / 2.0, Vec3d::UnitZ()).toRotationMatrix();
        const Mat3d R = seen.axes * turn * face.axes.transpose();
        std::array<Interval, 2> allowed;
        double filled = 1.0;
        for (int axis = 0; axis < 2; ++axis) {
            const Vec3d direction = seen.axes.col(axis);
            const Interval part = shadow(seen, direction);
            const Interval whole = shadow(face, R.transpose() * direction);
            allowed[static_cast<std::size_t>(axis)] = shifts(part, whole, slack_);
            filled *= share(part, whole);
        }
        if (allowed[0].length() < 0.0 || allowed[1].length() < 0.0) continue;
        const Vec3d up = seen.normal();
        const double height = up.dot(seen.center) - up.dot(R * face.center);
        for (const double x : at_ends(allowed[0], slack_)) {
            for (const double y : at_ends(allowed[1], slack_)) {
                add(R, x * seen.axes.col(0) + y * seen.axes.col(1) + height * up, filled);
            }
        }
    }
}

double angle_between(const FlatFace& a, const FlatFace& b) {
    return std::acos(std::clamp(a.normal().dot(b.normal()), -1.0, 1.0));
}

// Two normals as a frame, whose x lies halfway between them and z along both planes.
Mat3d frame_of(const FlatFace& a, const FlatFace& b) {
    Mat3d frame;
    frame.col(0) = (a.normal() + b.normal()).normalized();
    frame.col(2) = a.normal().cross(b.normal()).normalized();
    frame.col(1) = frame.col(2).cross(frame.col(0));
    return frame;
}

// Planes fix the turn, and the place but along their common line; there, ends meet ends.
void FaceMatcher::match_two(const FlatFace& seen, const FlatFace& seen2, const FlatFace& face,
                            const FlatFace& face2) {
    const Mat3d frame = frame_of(seen, seen2);
    const Mat3d R = frame * frame_of(face, face2).transpose();
    const Vec3d line = frame.col(2);
    Mat3d planes;
    planes.row(0) = seen.normal();
    planes.row(1) = seen2.normal();
    planes.row(2) = line;
    const Vec3d heights(seen.normal().dot(seen.center - R * face.center),
                        seen2.normal().dot(seen2.center - R * face2.center), 0.0);
    const Vec3d t = planes.inverse() * heights;
    const auto across = [&](const FlatFace& part, const FlatFace& whole) {
        const Vec3d direction = part.normal().cross(line);
        const double shift = direction.dot(t);
        const Interval allowed =
            shifts(shadow(part, direction), shadow(whole, R.transpose() * direction), slack_);
        return allowed.low <= shift && shift <= allowed.high;
    };
    if (!across(seen, face) || !across(seen2, face2)) return;
    const Interval part = shadow(seen, line);
    const Interval part2 = shadow(seen2, line);
    const Interval whole = shadow(face, R.transpose() * line);
    const Interval whole2 = shadow(face2, R.transpose() * line);
    const Interval first = shifts(part, whole, slack_);
    const Interval second = shifts(part2, whole2, slack_);
    const Interval both{std::max(first.low, second.low), std::min(first.high, second.high)};
    if (both.length() < 0.0) return;
    const double filled = 0.5 * (share(part, whole) + share(part2, whole2));
    for (const double z : at_ends(both, slack_)) add(R, t + z * line, filled);
}

void FaceMatcher::match_two(const FlatFace& seen, const FlatFace& seen2) {
    const double angle = angle_between(seen, seen2);
    if (angle < kLeastTurn || angle > kPi - kLeastTurn) return;
    for (const FlatFace& face : model_) {
        for (const FlatFace& face2 : model_) {
            if (std::abs(angle_between(face, face2) - angle) > kAngleSlack) continue;
            match_two(seen, seen2, face, face2);
        }
    }
}

double reach_of(const FlatFace& face) {
    double reach = 0.0;
    for (const Vec3d& corner : face.outline) {
        reach = std::max(reach, (corner - face.center).norm());
    }
    return reach;
}

}  // namespace

std::vector<FlatFace> flat_faces(const PointCloud& cloud, double sampling) {
    PatchSettings patches;
    patches.sampling = sampling;
    std::vector<FlatFace> faces;
    for (PlanePiece& piece : find_planes(cloud, patches)) {
        FlatFace face;
        face.center = piece.T_cloud_piece.translation();
        face.axes = piece.T_cloud_piece.linear();
        face.extent = piece.extents.x();
        Vec3f outward = Vec3f::Zero();
        for (const std::uint32_t i : piece.indices) outward += cloud.normals[i];
        if (outward.cast<double>().dot(face.normal()) < 0.0) face.axes.rightCols<2>() *= -1.0;
        for (int d = 0; d < kOutlineDirections; ++d) {
            const double angle = 2.0 * kPi * d / kOutlineDirections;
            const Vec3f direction =
                Vec3d(std::cos(angle) * face.axes.col(0) + std::sin(angle) * face.axes.col(1))
                    .cast<float>();
            const auto farthest = std::max_element(
                piece.indices.begin(), piece.indices.end(), [&](std::uint32_t i, std::uint32_t j) {
                    return direction.dot(cloud.points[i]) < direction.dot(cloud.points[j]);
                });
            face.outline.push_back(cloud.points[*farthest].cast<double>());
        }
        face.indices = std::move(piece.indices);
        faces.push_back(std::move(face));
    }
    return faces;
}

std::vector<Pose> poses_from_faces(std::span<const FlatFace> scene, std::span<const FlatFace> model,
                                   double slack, std::size_t most) {
    FaceMatcher matcher(model, slack);
    for (const FlatFace& seen : scene) {
        for (const FlatFace& face : model) matcher.match_one(seen, face);
        for (const FlatFace& seen2 : scene) {
            if (&seen == &seen2) continue;
            const double apart = (seen.center - seen2.center).norm();
            if (apart < reach_of(seen) + reach_of(seen2) + slack) matcher.match_two(seen, seen2);
        }
    }
    std::vector<Guess>& guesses = matcher.guesses;
    std::stable_sort(guesses.begin(), guesses.end(),
                     [](const Guess& a, const Guess& b) { return a.filled > b.filled; });
    if (guesses.size() > most) guesses.resize(most);
    std::vector<Pose> poses;
    poses.reserve(guesses.size());
    for (const Guess& guess : guesses) poses.push_back(guess.T_scene_model);
    return poses;
}

}  // namespace ostraka
