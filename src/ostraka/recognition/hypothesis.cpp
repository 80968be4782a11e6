// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/hypothesis.hpp"

#include <algorithm>
#include <cmath>

namespace ostraka {
namespace {

constexpr float kMinAgreement = 0.7F;  // cosine between the normals of model and scan
constexpr float kMinSlope = 0.3F;      // cosine of incidence below which tolerance grows no further

}  // namespace

std::string_view source_name(HypothesisSource source) {
    return source == HypothesisSource::segment ? "segment" : "keypoints";
}

Evidence gather_evidence(const Scan& scan, const ModelProbe& probe, const Pose& T_scene_model,
                         double tolerance) {
    const Mat3f R = T_scene_model.linear().cast<float>();
    const Vec3f t = T_scene_model.translation().cast<float>();
    const Vec3f eye = scan.ranges.viewpoint();
    const auto& visible = probe.visible_from(R.transpose() * (eye - t));
    const auto limit = static_cast<float>(tolerance);
    const Vec3f up = scan.table ? Vec3f(scan.table->normal.cast<float>()) : Vec3f::Zero();
    const float ground = scan.table ? static_cast<float>(scan.table->offset) - 2.0F * limit : 0.0F;
    Evidence evidence;
    for (std::size_t i = 0; i < probe.samples().size(); ++i) {
        if (!visible[i]) continue;
        ++evidence.visible;
        const Vec3f point = R * probe.samples()[i] + t;
        if (scan.table && up.dot(point) < ground) ++evidence.sunk;
        const std::uint32_t index = scan.ranges.cell_of(point);
        if (index == kNoIndex || !scan.ranges[index].measured()) {
            ++evidence.missing;
            continue;
        }
        const RangeCell& cell = scan.ranges[index];
        const Vec3f normal = R * probe.normals()[i];
        const Vec3f ray = point - eye;
        const float range = ray.norm();
        const float slope = std::max(kMinSlope, -normal.dot(ray) / range);
        const float slack = limit / slope;
        if (range > cell.far + slack) {
            ++evidence.hidden;
        } else if (range < cell.near - slack) {
            ++evidence.violation;
        } else if (cell.point != kNoIndex &&
                   normal.dot(scan.cloud.normals[cell.point]) < kMinAgreement) {
            ++evidence.violation;
        } else {
            ++evidence.support;
        }
    }
    return evidence;
}

double quick_score(const Evidence& evidence) {
    return (evidence.support - 1.0 * evidence.violation - 0.5 * evidence.missing -
            0.5 * evidence.sunk) /
           static_cast<double>(kProbeSamples);
}

}  // namespace ostraka
