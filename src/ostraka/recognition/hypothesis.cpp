// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/hypothesis.hpp"

#include "ostraka/recognition/cell_check.hpp"
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
    const Vec3f up = scan.table ? Vec3f(scan.table->normal.cast<float>()) : Vec3f::Zero();
    const float ground = scan.table ? static_cast<float>(scan.table->offset) - 2.0F * limit : 0.0F;
    const auto largest = static_cast<float>(probe.model().shape.diameter);
    Evidence evidence;
    for (std::size_t i = 0; i < std::min(samples, probe.samples().size()); ++i) {
        if (!visible[i]) continue;
        ++evidence.visible;
        SurfacePiece piece{R * probe.samples()[i] + t, R * probe.normals()[i]};
        if (scan.table && up.dot(piece.point) < ground) ++evidence.sunk;
        const Vec3f ray = piece.point - eye;
        piece.range = ray.norm();
        piece.slope = -piece.normal.dot(ray) / piece.range;
        count(check_free_cell(scan, scan.ranges.cell_of(piece.point), piece, limit, largest), limit,
              evidence);
    }
    evidence.samples = static_cast<int>(samples);
    return evidence;
}

double quick_score(const Evidence& evidence) {
    return (evidence.fit - 1.0 * evidence.violation - 0.5 * evidence.missing -
            0.5 * evidence.sunk) /
           static_cast<double>(evidence.samples);
}

}  // namespace ostraka
