// SPDX-License-Identifier: Apache-2.0
// Records made by hand, and a small set to run whole evaluations on.
#pragma once

#include "ostraka/base/random.hpp"
#include "ostraka/evaluation/scenes.hpp"
#include "support/simple_models.hpp"

namespace ostraka::evaluation_testing {

inline Pose shifted(double x, double y = 0.0, double z = 0.0) {
    Pose pose = Pose::Identity();
    pose.translation() = Vec3d(x, y, z);
    return pose;
}

/// Models "a" and "b" of diameter 10, clouds without shape: poses differ by shifts only.
inline ModelLibrary two_models() {
    ModelLibrary library;
    Random random(2);
    for (const char* name : {"a", "b"}) {
        Model model;
        model.name = name;
        model.shape.diameter = 10.0;
        model.shape.radius = 5.0;
        for (int i = 0; i < 300; ++i) {
            model.surface.points.push_back(
                Vec3d(5.0 * random.uniform() * random.direction()).cast<float>());
        }
        model.mesh.vertices = model.surface.points;
        library.models.push_back(model);
    }
    return library;
}

inline RecognizedObject report_at(std::uint32_t model, double x, double confidence = 0.97) {
    return {.model = model == 0 ? "a" : "b",
            .model_index = model,
            .T_scene_model = shifted(x),
            .confidence = confidence};
}

inline TrueObject truth_at(std::uint32_t model, double x, double visible_fraction) {
    return {.model = model, .T_scene_model = shifted(x), .visible_fraction = visible_fraction};
}

/// What the judge makes of given truth and reports, without a scan.
inline SceneRecord record_for(const ModelLibrary& library, std::vector<TrueObject> truth,
                              std::vector<RecognizedObject> reports) {
    TestScene scene;
    scene.objects = std::move(truth);
    return record_of(PoseJudge(library, false), scene, std::move(reports), {});
}

/// A camera with few pixels, as wide as the default one.
inline PinholeCamera small_camera(int width = 128) {
    const double factor = width / 640.0;
    const int height = width * 3 / 4;
    return {width, height, 575.0 * factor, 575.0 * factor, (width - 1) / 2.0, (height - 1) / 2.0};
}

/// Corner and plate, built once.
inline const ModelLibrary& small_library() {
    static const ModelLibrary library =
        build_library(testing::simple_models(), testing::quick_settings());
    return library;
}

}  // namespace ostraka::evaluation_testing
