// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/scenes.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/mesh/symmetry_poses.hpp"

namespace ostraka {
namespace {

constexpr int kSymmetrySteps = 315;  // of a full turn: as BOP's toolkit, ceil(pi / 0.01)

// Distances from the camera's center; 0 where nothing was measured.
std::vector<double> scanned_distances(const PointCloud& cloud) {
    std::vector<double> distances(cloud.size(), 0.0);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (cloud.points[i].allFinite()) distances[i] = cloud.points[i].cast<double>().norm();
    }
    return distances;
}

std::vector<double> clutter_of(const TestScene& scene) {
    std::vector<double> own(scene.objects.size(), 0.0);
    double all = 0.0;
    for (std::size_t i = 0; i < scene.labels.size(); ++i) {
        if (!scene.cloud.points[i].allFinite()) continue;
        all += 1.0;
        if (scene.labels[i] != kNoIndex) own[scene.labels[i]] += 1.0;
    }
    for (double& value : own) value = all > 0.0 ? 1.0 - value / all : 1.0;
    return own;
}

}  // namespace

PoseJudge::PoseJudge(const ModelLibrary& library, bool vsd) : library_(&library) {
    for (const Model& model : library.models) {
        symmetries_.push_back(symmetry_motions(model.symmetry, kSymmetrySteps));
        if (vsd) rays_.emplace_back(model.mesh);
    }
}

std::vector<PosePair> PoseJudge::judge(const TestScene& scene,
                                       std::span<const RecognizedObject> reports,
                                       const SceneSettings& settings) const {
    std::vector<PosePair> pairs;
    for (std::uint32_t r = 0; r < reports.size(); ++r) {
        for (std::uint32_t t = 0; t < scene.objects.size(); ++t) {
            if (scene.objects[t].model != reports[r].model_index) continue;
            const MeshShape& shape = library_->models[reports[r].model_index].shape;
            const Vec3d off = reports[r].T_scene_model * shape.center -
                              scene.objects[t].T_scene_model * shape.center;
            if (off.norm() < shape.diameter) pairs.push_back({.report = r, .truth = t});
        }
    }
    const bool vsd = settings.vsd && scene.camera.has_value();
    const std::vector<double> scan = vsd ? scanned_distances(scene.cloud) : std::vector<double>();
    VsdSettings vsd_settings;
    vsd_settings.delta =
        settings.vsd_delta * unit_factor(Unit::millimeter, library_->settings.unit);
    parallel_for(pairs.size(), [&](std::size_t i) {
        PosePair& pair = pairs[i];
        const std::uint32_t m = reports[pair.report].model_index;
        const Model& model = library_->models[m];
        const Pose& truth = scene.objects[pair.truth].T_scene_model;
        const Pose& report = reports[pair.report].T_scene_model;
        const double diameter = model.shape.diameter;
        pair.adi = adi_error(model.surface.points, truth, report) / diameter;
        pair.mssd = mssd_error(model.mesh.vertices, symmetries_[m], truth, report) / diameter;
        pair.degrees = symmetric_difference(model.symmetry, truth, report).angle * 180.0 / kPi;
        if (!scene.camera) return;
        pair.mspd = mspd_error(model.mesh.vertices, symmetries_[m], truth, report, *scene.camera);
        if (!vsd) return;
        pair.vsd =
            vsd_errors(scan, distance_image(rays_[m], *scene.camera, truth),
                       distance_image(rays_[m], *scene.camera, report), diameter, vsd_settings);
    });
    return pairs;
}

SceneRecord record_of(const PoseJudge& judge, const TestScene& scene,
                      std::vector<RecognizedObject> reports, const SceneSettings& settings) {
    SceneRecord record{.name = scene.name,
                       .scene = scene.scene,
                       .image = scene.image,
                       .truth = scene.objects,
                       .clutter = clutter_of(scene)};
    std::stable_sort(reports.begin(), reports.end(),
                     [](const auto& a, const auto& b) { return a.confidence > b.confidence; });
    record.pairs = judge.judge(scene, reports, settings);
    record.reports = std::move(reports);
    record.image_width = scene.camera ? scene.camera->width : 0;
    return record;
}

SceneRecord try_scene(const Recognizer& recognizer, const PoseJudge& judge, const TestScene& scene,
                      const SceneSettings& settings) {
    const Stopwatch watch;
    RecognitionSettings recognition = settings.recognition;
    recognition.viewpoint_known = recognition.viewpoint_known && scene.viewpoint_known;
    Recognition answer = recognizer.recognize(scene.cloud, recognition);
    const double seconds = watch.seconds();
    SceneRecord record = record_of(judge, scene, std::move(answer.objects), settings);
    record.seconds = std::move(answer.seconds);
    record.seconds["all"] = seconds;
    return record;
}

Matching match(const SceneRecord& record, const ModelLibrary& library,
               const MatchSettings& settings) {
    std::vector<PosePair> pairs;
    for (const PosePair& pair : record.pairs) {
        const bool reported = record.reports[pair.report].confidence >= settings.min_confidence;
        if (reported && pair.adi < settings.max_adi) pairs.push_back(pair);
    }
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const PosePair& a, const PosePair& b) { return a.adi < b.adi; });
    std::vector<bool> report_used(record.reports.size(), false);
    std::vector<bool> truth_used(record.truth.size(), false);
    Matching matching;
    for (const PosePair& pair : pairs) {
        if (report_used[pair.report] || truth_used[pair.truth]) continue;
        report_used[pair.report] = truth_used[pair.truth] = true;
        if (record.truth[pair.truth].visible_fraction >= settings.min_visible) {
            matching.hits.push_back(pair);
        }
    }
    for (std::uint32_t r = 0; r < record.reports.size(); ++r) {
        if (report_used[r] || record.reports[r].confidence < settings.min_confidence) continue;
        matching.wrong.push_back(r);
    }
    for (std::uint32_t t = 0; t < record.truth.size(); ++t) {
        if (truth_used[t] || record.truth[t].visible_fraction < settings.min_visible) continue;
        matching.misses.push_back(t);
        // Whatever is reported where the object's middle is was reported in its place.
        const MeshShape& shape = library.models[record.truth[t].model].shape;
        double nearest = 0.5 * shape.diameter;
        std::uint32_t instead = kNoIndex;
        for (const std::uint32_t r : matching.wrong) {
            const MeshShape& other = library.models[record.reports[r].model_index].shape;
            const double off = (record.truth[t].T_scene_model * shape.center -
                                record.reports[r].T_scene_model * other.center)
                                   .norm();
            if (off >= nearest) continue;
            nearest = off;
            instead = r;
        }
        matching.instead.push_back(instead);
    }
    return matching;
}

}  // namespace ostraka
