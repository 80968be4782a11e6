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

// Logistic regression on simulated scenes; see docs/recognition.md.
double confidence_of(const Verified& v, const Scan& scan, const MeshShape& shape) {
    if (v.support < kMinSupport || v.silhouette == 0) return 0.0;
    const auto support = static_cast<double>(v.support);
    const double judged =
        support + static_cast<double>(v.violation) + 0.5 * static_cast<double>(v.missing);
    const double agreement = support / judged;
    const double cell_area = scan.sampling * scan.sampling;
    const double area = support * cell_area / (shape.diameter * shape.diameter);
    const double logit = 22.0 * (agreement - 0.80) + 14.0 * std::min(v.visible_fraction, 0.5) +
                         10.0 * std::min(area, 0.12) - 3.2 - 20.0 * v.sunk;
    return 1.0 / (1.0 + std::exp(-logit));
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
    double squares = 0.0;
    std::size_t sunk = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (!hits[i].hit()) continue;
        ++result.silhouette;
        const RangeCell& cell = scan.ranges[window[i]];
        const Vec3d direction = scan.ranges.direction(window[i]);
        const double range = hits[i].distance;
        if (scan.table) {
            const double height = scan.table->normal.dot(eye + range * direction);
            if (height < scan.table->offset - 2.0 * tolerance) ++sunk;
        }
        if (!cell.measured()) {
            ++result.missing;
            continue;
        }
        // The smoothed normal of the surface there: single triangles of a scanned mesh are rough.
        const Vec3f at = Vec3d(T_model_scene * Vec3d(eye + range * direction)).cast<float>();
        const std::uint32_t nearest = probe.field().nearest(at);
        Vec3d normal = nearest == kNoIndex ? probe.rays().normal(hits[i])
                                           : Vec3d(probe.field().normal(nearest).cast<double>());
        normal = T_scene_model.linear() * normal;
        const double slope = std::max(kMinSlope, -normal.dot(direction));
        const double slack = tolerance / slope;
        const double off = range > double{cell.far}    ? range - double{cell.far}
                           : range < double{cell.near} ? range - double{cell.near}
                                                       : 0.0;
        const bool turned =
            cell.point != kNoIndex &&
            normal.dot(scan.cloud.normals[cell.point].cast<double>()) < kMinAgreement;
        if (off > slack) {
            ++result.hidden;
        } else if (off < -slack || turned) {
            ++result.violation;
        } else {
            ++result.support;
            result.cells.push_back(window[i]);
            squares += off * slope * off * slope;
        }
    }
    if (result.support > 0) {
        result.inlier_rms = std::sqrt(squares / static_cast<double>(result.support));
    }
    if (result.silhouette > 0) {
        result.visible_fraction =
            static_cast<double>(result.support) / static_cast<double>(result.silhouette);
        result.sunk = static_cast<double>(sunk) / static_cast<double>(result.silhouette);
    }
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
