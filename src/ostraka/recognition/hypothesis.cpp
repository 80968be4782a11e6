// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/hypothesis.hpp"

#include <array>

#include "ostraka/recognition/cell_check.hpp"
#include "ostraka/recognition/ground.hpp"
#include "ostraka/recognition/merged_scan.hpp"

namespace ostraka {
namespace {

void count(const CellCheck& check, float tolerance, Evidence& evidence) {
    switch (check.verdict) {
        case CellVerdict::support: {
            const float ratio = check.off / tolerance;
            evidence.fit += double{1.0F - ratio * ratio};
            ++evidence.support;
            break;
        }
        case CellVerdict::hidden:
            ++evidence.hidden;
            break;
        case CellVerdict::violation:
        case CellVerdict::backdrop:
            ++evidence.violation;
            break;
        case CellVerdict::missing:
            ++evidence.missing;
            break;
        case CellVerdict::unsure:
        case CellVerdict::taken:
        case CellVerdict::outside:
            ++evidence.unsure;
            break;
    }
}

// Support by what another object explains is none.
CellCheck check_free_cell(const Scan& scan, std::uint32_t cell, const SurfacePiece& piece,
                          float tolerance, float largest) {
    CellCheck check = check_cell(scan, cell, piece, tolerance, largest);
    const bool taken = check.verdict == CellVerdict::support && !scan.explained.empty() &&
                       scan.explained[scan.ranges[cell].point];
    if (taken) check.verdict = CellVerdict::taken;
    return check;
}

// Pieces whose cells are fetched while those of others are found: each alone would wait for memory.
class Batch {
  public:
    Batch(const Scan& scan, float tolerance, float largest)
        : scan_(scan), tolerance_(tolerance), largest_(largest) {}

    void add(const SurfacePiece& piece, Evidence& evidence) {
        const std::uint32_t cell = scan_.ranges.cell_of(piece.point);
        if (cell != kNoIndex) __builtin_prefetch(&scan_.ranges[cell]);
        looked_at_[filled_++] = {piece, cell};
        if (filled_ == looked_at_.size()) judge(evidence);
    }
    void judge(Evidence& evidence) {
        for (std::size_t i = 0; i < filled_; ++i) fetch_point(looked_at_[i].cell);
        for (std::size_t i = 0; i < filled_; ++i) {
            const auto& [piece, cell] = looked_at_[i];
            count(check_free_cell(scan_, cell, piece, tolerance_, largest_), tolerance_, evidence);
        }
        filled_ = 0;
    }

  private:
    void fetch_point(std::uint32_t cell) const {
        if (cell == kNoIndex) return;
        const std::uint32_t point = scan_.ranges[cell].point;
        if (point == kNoIndex) return;
        __builtin_prefetch(&scan_.cloud.normals[point]);
        __builtin_prefetch(&scan_.cloud.points[point]);
    }
    struct LookedAt {
        SurfacePiece piece;
        std::uint32_t cell = kNoIndex;
    };
    const Scan& scan_;
    float tolerance_;
    float largest_;
    std::array<LookedAt, 64> looked_at_;
    std::size_t filled_ = 0;
};

}  // namespace

std::string_view source_name(HypothesisSource source) {
    switch (source) {
        case HypothesisSource::segment:
            return "segment";
        case HypothesisSource::keypoints:
            return "keypoints";
        case HypothesisSource::faces:
            return "faces";
    }
    return "";
}

Evidence gather_evidence(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model,
                         double tolerance, std::size_t samples) {
    if (scan.merged) return gather_merged_evidence(scan, probe, T_scene_model, tolerance, samples);
    const Mat3f R = T_scene_model.linear().cast<float>();
    const Vec3f t = T_scene_model.translation().cast<float>();
    const Vec3f eye = scan.ranges.viewpoint();
    const auto& visible = probe.visible_from(R.transpose() * (eye - t));
    const auto limit = static_cast<float>(tolerance);
    const Ground ground(scan, tolerance);
    Evidence evidence;
    Batch batch(scan, limit, static_cast<float>(probe.model().shape.diameter));
    for (std::size_t i = 0; i < std::min(samples, probe.samples().size()); ++i) {
        if (!visible[i]) continue;
        ++evidence.visible;
        SurfacePiece piece{R * probe.samples()[i] + t, R * probe.normals()[i]};
        if (ground.covers(piece.point)) ++evidence.sunk;
        const Vec3f ray = piece.point - eye;
        piece.range = ray.norm();
        piece.slope = -piece.normal.dot(ray) / piece.range;
        batch.add(piece, evidence);
    }
    batch.judge(evidence);
    evidence.samples = static_cast<int>(samples);
    return evidence;
}

double quick_score(const Evidence& evidence) {
    return (evidence.fit - 1.0 * evidence.violation - 0.5 * evidence.missing -
            0.5 * evidence.sunk) /
           static_cast<double>(evidence.samples);
}

}  // namespace ostraka
