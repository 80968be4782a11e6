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
constexpr int kInward = 2;               // cells from the outline into the model, past the rim,
constexpr int kOutward = 3;              // and out of it, where normals are those of one side only
constexpr float kContinues = 0.9F;       // cosine between normals on both sides of a smooth surface
constexpr std::size_t kMinOutline = 12;  // cells of outline; fewer say nothing
constexpr double kMaxOpen = 0.3;         // open share of the outline that true objects reach

// Logistic regression on simulated scenes, and a penalty for what only fits into a larger surface;
// see docs/recognition.md.
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

// The cells of a window of the range map that a placed model covers.
class Silhouette {
  public:
    Silhouette(const RangeMap& ranges, const std::vector<std::uint32_t>& window,
               const std::vector<RayHit>& hits)
        : width_(static_cast<int>(ranges.width())), height_(static_cast<int>(ranges.height())) {
        if (window.empty()) return;
        low_u_ = static_cast<int>(window.front()) % width_;
        low_v_ = static_cast<int>(window.front()) / width_;
        columns_ = static_cast<int>(window.back()) % width_ - low_u_ + 1;
        for (const RayHit& hit : hits) covered_.push_back(hit.hit());
    }
    bool covers(int u, int v) const {
        const int column = u - low_u_;
        const int row = v - low_v_;
        if (column < 0 || row < 0 || column >= columns_) return false;
        const auto i = static_cast<std::size_t>(row * columns_ + column);
        return i < covered_.size() && covered_[i];
    }
    std::uint32_t cell(int u, int v) const {
        if (u < 0 || v < 0 || u >= width_ || v >= height_) return kNoIndex;
        return static_cast<std::uint32_t>(v * width_ + u);
    }
    int u(std::uint32_t cell) const { return static_cast<int>(cell) % width_; }
    int v(std::uint32_t cell) const { return static_cast<int>(cell) / width_; }

  private:
    int width_;
    int height_;
    int low_u_ = 0;
    int low_v_ = 0;
    int columns_ = 0;
    std::vector<bool> covered_;
};

// Whether a cell of the silhouette and one outside of it show one smooth surface.
bool continues(const Scan& scan, const Silhouette& silhouette, std::uint32_t inside,
               std::uint32_t outside) {
    if (inside == kNoIndex || outside == kNoIndex) return false;
    const std::uint32_t a = scan.ranges[inside].point;
    const std::uint32_t b = scan.ranges[outside].point;
    if (a == kNoIndex || b == kNoIndex || !scan.ranges[outside].measured()) return false;
    // A cell may have borrowed its point from the rim of the model.
    const std::uint32_t own = scan.ranges.cell_of(scan.cloud.points[b]);
    if (own == kNoIndex || silhouette.covers(silhouette.u(own), silhouette.v(own))) return false;
    const Vec3f& normal = scan.cloud.normals[a];
    if (normal.dot(scan.cloud.normals[b]) < kContinues) return false;
    const float off = normal.dot(scan.cloud.points[b] - scan.cloud.points[a]);
    return std::abs(off) < static_cast<float>(scan.sampling);
}

// Clutter in the sense of Aldoma et al.: surface that belongs to what the model explains but lies
// beyond the model. A flat face fits into any wall; the wall goes on where the model ends.
double open_share(const Scan& scan, const Silhouette& silhouette,
                  const std::vector<std::uint32_t>& supported) {
    std::size_t outline = 0;
    std::size_t open = 0;
    for (const std::uint32_t cell : supported) {
        const int u = silhouette.u(cell);
        const int v = silhouette.v(cell);
        for (const auto& [du, dv] :
             {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
            if (silhouette.covers(u + du, v + dv)) continue;
            if (silhouette.covers(u + kOutward * du, v + kOutward * dv)) continue;
            const std::uint32_t inside = silhouette.cell(u - kInward * du, v - kInward * dv);
            if (!std::binary_search(supported.begin(), supported.end(), inside)) continue;
            ++outline;
            const std::uint32_t outside = silhouette.cell(u + kOutward * du, v + kOutward * dv);
            if (continues(scan, silhouette, inside, outside)) ++open;
        }
    }
    return outline < kMinOutline ? 0.0 : static_cast<double>(open) / static_cast<double>(outline);
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
    result.open = open_share(scan, Silhouette(scan.ranges, window, hits), result.cells);
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
