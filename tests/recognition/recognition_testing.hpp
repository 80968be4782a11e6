// SPDX-License-Identifier: Apache-2.0
// A tiny library and scans of its models with known truth, shared by the tests of recognition.
#pragma once

#include <gtest/gtest.h>

#include "ostraka/base/random.hpp"
#include "ostraka/evaluation/pose_errors.hpp"
#include "ostraka/recognition/hypothesis.hpp"
#include "ostraka/recognition/recognize.hpp"
#include "ostraka/simulation/scene.hpp"
#include "support/simple_models.hpp"

namespace ostraka::recognition_testing {

inline constexpr std::uint32_t kCorner = 0;  // simple_models() in the order of their names
inline constexpr std::uint32_t kPlate = 1;

inline const ModelLibrary& library() {
    static const ModelLibrary built =
        build_library(testing::simple_models(), testing::quick_settings());
    return built;
}

inline const ModelProbe& probe(std::uint32_t model) {
    static const ModelProbe corner(library().models[kCorner], library().settings.sampling);
    static const ModelProbe plate(library().models[kPlate], library().settings.sampling);
    return model == kCorner ? corner : plate;
}

inline const SceneModels& models() {
    static const SceneModels made = scene_models({testing::corner_model(), testing::plate_model()});
    return made;
}

/// The chosen models beside each other on a table, without hiding each other much.
inline SimulatedScene tabletop(const std::vector<std::uint32_t>& chosen, std::uint64_t number) {
    TabletopSettings settings;
    settings.spacing = 1.4;
    settings.min_elevation = 0.7;
    settings.seed = 11;
    return simulate_tabletop(models(), chosen, number, settings);
}

/// One model in front of nothing.
inline SimulatedScene alone(std::uint32_t model, std::uint64_t seed) {
    PlacedModel placed{model, Pose::Identity()};
    placed.T_world_model.linear() = Random(seed).rotation();
    placed.T_world_model.translation() =
        -(placed.T_world_model.linear() * models().shapes[model].center);
    const SceneView view{.T_camera_world = look_at(Vec3d(0, -420, 60), Vec3d::Zero())};
    return simulate_scene(models(), {&placed, 1}, view);
}

/// A mesh as it is, seen from `eye`.
inline SimulatedScene scan_of(const TriangleMesh& mesh, const Vec3d& eye, double noise) {
    const SceneModels meshes = scene_models({mesh});
    const PlacedModel placed{0, Pose::Identity()};
    SceneView view{.T_camera_world = look_at(eye, Vec3d::Zero())};
    view.sensor.ranging.noise = noise;
    return simulate_scene(meshes, {&placed, 1}, view);
}

inline Scan prepared(const SimulatedScene& scene) {
    double diameter = 0.0;
    for (const Model& model : library().models) diameter = std::max(diameter, model.shape.diameter);
    return prepare_scan(scene.cloud, library().settings.sampling, diameter, {});
}

/// Tolerance of agreement in the library's unit.
inline double tolerance() {
    return RecognitionSettings{}.tolerance * library().settings.sampling;
}

/// ADI in model diameters.
inline double pose_error(const ModelLibrary& of, std::uint32_t model, const Pose& truth,
                         const Pose& estimate) {
    const Model& m = of.models[model];
    return adi_error(m.surface.points, truth, estimate) / m.shape.diameter;
}
inline double pose_error(std::uint32_t model, const Pose& truth, const Pose& estimate) {
    return pose_error(library(), model, truth, estimate);
}

/// A pose turned by `angle` about the model's center and shifted by `shift`, in random directions.
inline Pose disturbed(const Pose& T_scene_model, const Vec3d& center, double angle, double shift,
                      std::uint64_t seed) {
    Random random(seed);
    Pose T_scene_moved = T_scene_model;
    T_scene_moved.linear() =
        Eigen::AngleAxisd(angle, random.direction()).toRotationMatrix() * T_scene_model.linear();
    T_scene_moved.translation() =
        T_scene_model * center - T_scene_moved.linear() * center + shift * random.direction();
    return T_scene_moved;
}

}  // namespace ostraka::recognition_testing
