// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/verification.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "ostraka/recognition/cell_check.hpp"
#include "ostraka/recognition/contradiction.hpp"
#include "ostraka/recognition/ground.hpp"
#include "ostraka/recognition/merged_scan.hpp"

namespace ostraka {
namespace {

constexpr double kMissingWeight = 0.5;  // a missing return contradicts by half: sensors drop some

constexpr double kRegistration = 0.1;     // sampling distances: resampling and registration
constexpr double kDetailDeviation = 3.3;  // smoothing and resampling make of the detail; fitted to
                                          // simulated scans of statues and machine parts

// The model's surface where a ray meets it; smoothed, as single triangles of a scanned mesh are
// rough. Model frame.
Vec3d normal_at(const ModelProbe& probe, const RayHit& hit, const Vec3d& at) {
    const std::uint32_t nearest = probe.field().nearest(at.cast<float>());
    return nearest == kNoIndex ? probe.rays().normal(hit)
                               : Vec3d(probe.field().normal(nearest).cast<double>());
}

// How well a cell's own measurements agree with where the model is: 1 if they do, 0 from
// `tolerance` on, -1 if the sensor saw through the model.
double depth_fit(const RangeCell& cell, double range, double tolerance) {
    if (!cell.measured()) return 0.0;
    if (range > cell.far) return std::max(0.0, 1.0 - (range - cell.far) / tolerance);
    if (range < cell.near) return std::max(-1.0, 1.0 - (cell.near - range) / tolerance);
    return 1.0;
}

// Sums over the cells of a silhouette.
struct Sums {
    double squares = 0.0;
    double turned = 0.0;
    Mat3d normals = Mat3d::Zero();
};

void count(const CellCheck& check, const Vec3d& normal, Verified& result, Sums& sums) {
    ++result.silhouette;
    switch (check.verdict) {
        case CellVerdict::support:
            ++result.support;
            sums.squares += double{check.off} * double{check.off};
            sums.turned += 1.0 - double{check.agreement};
            sums.normals += normal * normal.transpose();
            break;
        case CellVerdict::hidden:
            ++result.hidden;
            break;
        case CellVerdict::violation:
            ++result.violation;
            break;
        case CellVerdict::backdrop:
            ++result.backdrop;
            break;
        case CellVerdict::missing:
            ++result.missing;
            break;
        case CellVerdict::unsure:
        case CellVerdict::taken:
        case CellVerdict::outside:
            ++result.unsure;
            break;
    }
}

void add_shares(const Sums& sums, Verified& result) {
    if (result.silhouette == 0) return;
    const auto silhouette = static_cast<double>(result.silhouette);
    result.visible_fraction = static_cast<double>(result.support) / silhouette;
    if (result.support == 0) return;
    const auto support = static_cast<double>(result.support);
    result.inlier_rms = std::sqrt(sums.squares / support);
    result.turned = sums.turned / support;
    const Eigen::SelfAdjointEigenSolver<Mat3d> scatter(sums.normals / support,
                                                       Eigen::EigenvaluesOnly);
    result.grip = 3.0 * std::max(0.0, scatter.eigenvalues()(0));
}

}  // namespace

double Verified::agreement() const {
    const double judged = static_cast<double>(support + violation + backdrop) +
                          kMissingWeight * static_cast<double>(missing);
    return judged > 0.0 ? static_cast<double>(support) / judged : 0.0;
}

double expected_deviation(const Scan& scan, const ModelProbe& probe) {
    return std::hypot(scan.deviation, kDetailDeviation * probe.detail(),
                      kRegistration * scan.sampling);
}

Verified verify(const Scan& scan, const ModelProbe& probe, const Hypothesis& hypothesis,
                double tolerance, CellVerdicts* detail) {
    if (scan.merged) return verify_merged(scan, probe, hypothesis, tolerance);
    Verified result;
    result.hypothesis = hypothesis;
    const Pose& T_scene_model = hypothesis.T_scene_model;
    const Pose T_model_scene = T_scene_model.inverse();
    const MeshShape& shape = probe.model().shape;
    const Vec3d eye = scan.ranges.viewpoint().cast<double>();
    const std::vector<std::uint32_t> window =
        scan.ranges.cells_around(T_scene_model * shape.center, shape.radius);
    std::vector<Vec3d> rays;
    rays.reserve(window.size());
    for (const std::uint32_t cell : window) {
        rays.push_back(T_model_scene.linear() * scan.ranges.direction(cell));
    }
    const std::vector<RayHit> hits = probe.rays().cast(T_model_scene * eye, rays);
    std::vector<CellVerdict> verdicts(window.size(), CellVerdict::outside);
    std::vector<bool> through(window.size(), false);
    Sums sums;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (!hits[i].hit()) continue;
        const double range = hits[i].distance;
        const Vec3d at = eye + range * scan.ranges.direction(window[i]);
        const Vec3d normal = T_scene_model.linear() * normal_at(probe, hits[i], T_model_scene * at);
        const SurfacePiece piece{at.cast<float>(), normal.cast<float>(), static_cast<float>(range),
                                 static_cast<float>(-normal.dot(scan.ranges.direction(window[i])))};
        const CellCheck check = check_cell(scan, window[i], piece, static_cast<float>(tolerance),
                                           static_cast<float>(shape.diameter));
        verdicts[i] = check.verdict;
        through[i] = check.through;
        if (check.verdict != CellVerdict::backdrop) {
            result.depth_fit += depth_fit(scan.ranges[window[i]], range, tolerance);
        }
        count(check, normal, result, sums);
        if (check.verdict == CellVerdict::support) result.cells.push_back(window[i]);
    }
    add_shares(sums, result);
    // What is out of sight, too.
    result.sunk = Ground(scan, tolerance).share(probe.samples(), T_scene_model);
    result.expected_rms = expected_deviation(scan, probe);
    result.noise = result.expected_rms / scan.sampling;
    const double cell_area = scan.cell * scan.cell;
    result.area =
        static_cast<double>(result.support) * cell_area / (shape.diameter * shape.diameter);
    result.solid = solid_contradiction(scan.ranges, window, verdicts);
    result.blank = solid_blank(scan.ranges, window, verdicts);
    result.hollow = hollow_contradiction(scan.ranges, window, verdicts, through);
    result.outline = judge_outline(scan, window, verdicts);
    if (detail != nullptr) *detail = {window, std::move(verdicts)};
    return result;
}

}  // namespace ostraka
