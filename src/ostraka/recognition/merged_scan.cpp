// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/merged_scan.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "ostraka/recognition/cell_check.hpp"
#include "ostraka/recognition/ground.hpp"
#include "ostraka/recognition/sharpness.hpp"

namespace ostraka {
namespace {

constexpr float kReach = 2.0F;             // sampling distances from a sample to the scan's point
constexpr std::size_t kMaxSamples = 4000;  // of a model's surface that are verified
constexpr float kBeside = 4.0F;            // sampling distances: points so near should be explained
constexpr double kDeep = 4.0;              // thicknesses: points so far inside are no noise
constexpr std::size_t kStray = 50;         // points on it, of which noise may put one inside
constexpr float kInward = -0.8F;           // cosine between a normal and what lies behind it

struct Placed {
    Mat3f R;
    Vec3f t;
    explicit Placed(const Pose& pose)
        : R(pose.linear().cast<float>()), t(pose.translation().cast<float>()) {}
    Vec3f operator()(const Vec3f& point) const { return R * point + t; }
};

bool seen_through(const Scan& scan, const Vec3f& point, const Vec3f& normal, float tolerance) {
    return std::any_of(scan.views.begin(), scan.views.end(), [&](const RangeMap& view) {
        const Vec3f ray = point - view.viewpoint();
        const float range = ray.norm();
        const float slope = -normal.dot(ray) / range;
        if (slope < kMinSlope) return false;
        const std::uint32_t cell = view.cell_of(point);
        if (cell == kNoIndex || !view[cell].measured()) return false;
        return range < view[cell].nearest_around - tolerance / slope;
    });
}

struct SurfaceCheck {
    CellCheck check;
    std::uint32_t point = kNoIndex;  // of the scan; of support
};

SurfaceCheck check_surface(const Scan& scan, const Vec3f& at, const Vec3f& normal,
                           float tolerance) {
    const std::uint32_t nearest = scan.merged->nearest(at);
    const auto reach = kReach * static_cast<float>(scan.sampling);
    const bool near =
        nearest != kNoIndex && (scan.cloud.points[nearest] - at).squaredNorm() < reach * reach;
    if (!near) {
        const bool through = seen_through(scan, at, normal, tolerance);
        return {{through ? CellVerdict::violation : CellVerdict::missing}};
    }
    const float agreement = normal.dot(scan.cloud.normals[nearest]);
    const float off = normal.dot(scan.cloud.points[nearest] - at);
    if (agreement < kMinAgreement || std::abs(off) > tolerance) return {{CellVerdict::unsure}};
    return {{CellVerdict::support, off, agreement}, nearest};
}

// Points of the scan about the model's surface: those on it, ascending, how many are not, and how
// many are deep inside.
struct PointsAround {
    std::vector<std::uint32_t> on;
    std::size_t beside = 0;
    std::size_t inside = 0;
};

PointsAround points_around(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model,
                           float tolerance) {
    const Placed to_model(T_scene_model.inverse(Eigen::Isometry));
    const auto reach = kBeside * static_cast<float>(scan.sampling);
    const auto deep = static_cast<float>(kDeep * scan.thickness);
    PointsAround around;
    for (std::uint32_t i = 0; i < scan.cloud.size(); ++i) {
        const Vec3f at = to_model(scan.cloud.points[i]);
        const std::uint32_t nearest = probe.field().nearest(at);
        if (nearest == kNoIndex) continue;
        const Vec3f offset = at - probe.field().point(nearest);
        const Vec3f& normal = probe.field().normal(nearest);
        if (offset.squaredNorm() > reach * reach) {
            if (normal.dot(offset) < std::min(kInward * offset.norm(), -deep)) ++around.inside;
            continue;
        }
        const bool on = std::abs(normal.dot(offset)) < 2.0F * tolerance &&
                        normal.dot(to_model.R * scan.cloud.normals[i]) > 0.0F;
        if (on) {
            around.on.push_back(i);
        } else {
            ++around.beside;
        }
    }
    return around;
}

}  // namespace

Evidence gather_merged_evidence(const Scan& scan, const ModelProbe& probe,
                                const Pose& T_scene_model, double tolerance, std::size_t samples) {
    const Placed placed(T_scene_model);
    const auto limit = static_cast<float>(tolerance);
    const Ground ground(scan, tolerance);
    Evidence evidence;
    const std::size_t count = std::min(samples, probe.samples().size());
    for (std::size_t i = 0; i < count; ++i) {
        ++evidence.visible;
        const Vec3f at = placed(probe.samples()[i]);
        if (ground.covers(at)) ++evidence.sunk;
        const SurfaceCheck found = check_surface(scan, at, placed.R * probe.normals()[i], limit);
        const CellVerdict verdict = found.check.verdict;
        const bool taken = verdict == CellVerdict::support && !scan.explained.empty() &&
                           scan.explained[found.point];
        if (verdict == CellVerdict::support && !taken) {
            const float ratio = found.check.off / limit;
            evidence.fit += double{1.0F - ratio * ratio};
            ++evidence.support;
        } else if (verdict == CellVerdict::violation) {
            ++evidence.violation;
        } else if (verdict == CellVerdict::missing) {
            ++evidence.missing;
        } else {
            ++evidence.unsure;
        }
    }
    evidence.samples = static_cast<int>(samples);
    return evidence;
}

Verified verify_merged(const Scan& scan, const ModelProbe& probe, const Hypothesis& hypothesis,
                       double tolerance) {
    Verified result;
    result.hypothesis = hypothesis;
    const Placed placed(hypothesis.T_scene_model);
    const auto limit = static_cast<float>(tolerance);
    const PointCloud& surface = probe.model().surface;
    const std::size_t stride = 1 + surface.size() / kMaxSamples;
    double squares = 0.0;
    Mat3d normals = Mat3d::Zero();
    for (std::size_t i = 0; i < surface.size(); i += stride) {
        ++result.silhouette;
        const Vec3f normal = placed.R * surface.normals[i];
        const SurfaceCheck found = check_surface(scan, placed(surface.points[i]), normal, limit);
        switch (found.check.verdict) {
            case CellVerdict::support:
                ++result.support;
                squares += double{found.check.off} * double{found.check.off};
                result.turned += 1.0 - double{found.check.agreement};
                normals += (normal * normal.transpose()).cast<double>();
                break;
            case CellVerdict::violation:
                ++result.violation;
                break;
            case CellVerdict::missing:
                ++result.hidden;  // nobody can tell
                break;
            default:
                ++result.unsure;
                break;
        }
    }
    PointsAround around = points_around(scan, probe, hypothesis.T_scene_model, limit);
    result.cells = std::move(around.on);
    result.violation += around.beside / stride;
    result.inside = around.inside - std::min(around.inside, result.cells.size() / kStray);
    result.sunk = Ground(scan, tolerance).share(probe.samples(), hypothesis.T_scene_model);
    if (result.support == 0) return result;
    const auto support = static_cast<double>(result.support);
    result.inlier_rms = std::sqrt(squares / support);
    result.expected_rms = expected_deviation(scan, probe);
    result.noise = result.expected_rms / scan.sampling;
    result.turned /= support;
    const Eigen::SelfAdjointEigenSolver<Mat3d> scatter(normals / support, Eigen::EigenvaluesOnly);
    result.grip = 3.0 * std::max(0.0, scatter.eigenvalues()(0));
    result.sharpness = sharpness(scan, probe, hypothesis.T_scene_model, result.cells);
    result.visible_fraction = support / static_cast<double>(result.silhouette);
    const double diameter = probe.model().shape.diameter;
    result.area = support * static_cast<double>(stride) * scan.sampling * scan.sampling /
                  (diameter * diameter);
    result.support = result.cells.size();
    result.depth_fit = support;
    return result;
}

}  // namespace ostraka
