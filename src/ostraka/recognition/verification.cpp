// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/verification.hpp"

#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr double kMinAgreement = 0.7;  // cosine between the normals of model and scan
constexpr double kMinSlope = 0.3;      // cosine of incidence below which tolerance grows no further
constexpr double kMaxShared = 0.35;    // of a hypothesis' support that better ones may have claimed
constexpr std::size_t kMinSupport = 40;  // cells; fewer say nothing
constexpr double kMaxOpen = 0.3;         // open share of the outline that true objects reach

// A logistic function with coefficients set by hand (not calibrated), and a penalty for what only
// fits into a larger surface; see docs/recognition.md.
double confidence_of(const Verified& v, const Scan& scan, const MeshShape& shape) {
    if (v.support < kMinSupport || v.silhouette == 0) return 0.0;
    const auto support = static_cast<double>(v.support);
    const double judged =
        support + static_cast<double>(v.violation) + 0.5 * static_cast<double>(v.missing);
    const double agreement = support / judged;
    const double cell_area = scan.sampling * scan.sampling;
    const double area = support * cell_area / (shape.diameter * shape.diameter);
    const double logit = 22.0 * (agreement - 0.80) + 14.0 * std::min(v.visible_fraction, 0.5) +
                         10.0 * std::min(area, 0.12) - 3.2 - 20.0 * v.sunk -
                         30.0 * std::max(0.0, v.open - kMaxOpen);
    return 1.0 / (1.0 + std::exp(-logit));
}

// One cell of the range map against the model's surface there.
struct CellCheck {
    CellVerdict verdict = CellVerdict::missing;
    double off = 0.0;  // along the normal, from the model to the scan; of support only
};

CellCheck check_cell(const Scan& scan, const RangeCell& cell, double range, const Vec3d& direction,
                     const Vec3d& normal, double tolerance) {
    if (!cell.measured()) return {};
    const double slope = std::max(kMinSlope, -normal.dot(direction));
    const double slack = tolerance / slope;
    const double off = range > double{cell.far}    ? range - double{cell.far}
                       : range < double{cell.near} ? range - double{cell.near}
                                                   : 0.0;
    const bool turned = cell.point != kNoIndex &&
                        normal.dot(scan.cloud.normals[cell.point].cast<double>()) < kMinAgreement;
    if (off > slack) return {CellVerdict::hidden, 0.0};
    if (off < -slack || turned) return {CellVerdict::violation, 0.0};
    return {CellVerdict::support, off * slope};
}

// The model's surface where a ray meets it; smoothed, as single triangles of a scanned mesh are
// rough. Model frame.
Vec3d normal_at(const ModelProbe& probe, const RayHit& hit, const Vec3d& at) {
    const std::uint32_t nearest = probe.field().nearest(at.cast<float>());
    return nearest == kNoIndex ? probe.rays().normal(hit)
                               : Vec3d(probe.field().normal(nearest).cast<double>());
}

void count(CellVerdict verdict, Verified& result) {
    ++result.silhouette;
    switch (verdict) {
        case CellVerdict::support:
            ++result.support;
            break;
        case CellVerdict::hidden:
            ++result.hidden;
            break;
        case CellVerdict::violation:
            ++result.violation;
            break;
        case CellVerdict::missing:
            ++result.missing;
            break;
        case CellVerdict::outside:
            break;
    }
}

void add_shares(double squares, std::size_t sunk, Verified& result) {
    if (result.support > 0) {
        result.inlier_rms = std::sqrt(squares / static_cast<double>(result.support));
    }
    if (result.silhouette > 0) {
        result.visible_fraction =
            static_cast<double>(result.support) / static_cast<double>(result.silhouette);
        result.sunk = static_cast<double>(sunk) / static_cast<double>(result.silhouette);
    }
}

}  // namespace

Verified verify(const Scan& scan, const ModelProbe& probe, const Hypothesis& hypothesis,
                double tolerance) {
    Verified result;
    result.hypothesis = hypothesis;
    const Pose& T_scene_model = hypothesis.T_scene_model;
    const Pose T_model_scene = T_scene_model.inverse();
    const MeshShape& shape = probe.model().shape;
    const Vec3d eye = scan.ranges.viewpoint().cast<double>();
    const std::vector<std::uint32_t> window =
        scan.ranges.cells_around(T_scene_model * shape.center, shape.radius);
    std::vector<Vec3d> rays;
    for (const std::uint32_t cell : window) {
        rays.push_back(T_model_scene.linear() * scan.ranges.direction(cell));
    }
    const std::vector<RayHit> hits = probe.rays().cast(T_model_scene * eye, rays);
    std::vector<CellVerdict> verdicts(window.size(), CellVerdict::outside);
    double squares = 0.0;
    std::size_t sunk = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (!hits[i].hit()) continue;
        const Vec3d direction = scan.ranges.direction(window[i]);
        const double range = hits[i].distance;
        const Vec3d at = eye + range * direction;
        if (scan.table && scan.table->normal.dot(at) < scan.table->offset - 2.0 * tolerance) {
            ++sunk;
        }
        const Vec3d normal = T_scene_model.linear() * normal_at(probe, hits[i], T_model_scene * at);
        const CellCheck check =
            check_cell(scan, scan.ranges[window[i]], range, direction, normal, tolerance);
        verdicts[i] = check.verdict;
        count(check.verdict, result);
        squares += check.off * check.off;
        if (check.verdict == CellVerdict::support) result.cells.push_back(window[i]);
    }
    add_shares(squares, sunk, result);
    result.open = open_share(scan, window, verdicts);
    result.confidence = confidence_of(result, scan, shape);
    return result;
}

std::vector<Verified> choose(std::vector<Verified> candidates, double min_confidence) {
    std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
        return a.confidence != b.confidence ? a.confidence > b.confidence : a.support > b.support;
    });
    std::vector<Verified> chosen;
    std::vector<std::uint32_t> claimed;
    for (Verified& candidate : candidates) {
        if (candidate.confidence < min_confidence) break;
        std::vector<std::uint32_t> shared;
        std::set_intersection(candidate.cells.begin(), candidate.cells.end(), claimed.begin(),
                              claimed.end(), std::back_inserter(shared));
        if (static_cast<double>(shared.size()) >
            kMaxShared * static_cast<double>(candidate.support)) {
            continue;
        }
        std::vector<std::uint32_t> all;
        std::set_union(candidate.cells.begin(), candidate.cells.end(), claimed.begin(),
                       claimed.end(), std::back_inserter(all));
        claimed = std::move(all);
        chosen.push_back(std::move(candidate));
    }
    return chosen;
}

}  // namespace ostraka
