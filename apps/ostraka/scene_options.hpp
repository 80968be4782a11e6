// SPDX-License-Identifier: Apache-2.0
// Which scenes to simulate, for all commands that do.
#pragma once

#include "common.hpp"
#include "ostraka/evaluation/test_scenes.hpp"
#include "ostraka/views/sensor_presets.hpp"

namespace ostraka::app {

struct SceneOptions {
    std::string kind = "random-views";
    std::string data;         // folder of a data set: its layout or its scans
    std::string data_unit;    // of a data set that states none
    std::string sensor;       // preset; empty: the kind's own camera with --noise only
    std::string bin;          // length,width,height in the scenes' unit; empty: by the models
    std::string choice = "";  // random or turns; empty: the kind's own
    int scenes = 60;
    int objects = 0;        // 0: the kind's own
    int width = 0;          // of the image; 0: the camera's own
    double noise = 0.0;     // standard deviation of depth, scenes' unit
    double spacing = 0.9;   // tabletop
    double distance = 0.0;  // scenes' unit; 0: the kind's own
    std::uint64_t seed = 0;
};

/// "tabletop", "drop", "bin", "random-views", "layout": what each is.
std::string scene_kinds_help();

/// All options but the kind and the noise. @param unit  what lengths are in, for the help.
void add_scene_options(CLI::App& command, SceneOptions& options, const std::string& unit);
/// "--noise" in that unit.
void add_scene_noise(CLI::App& command, SceneOptions& options, const std::string& unit);
/// "--on": the kind of scenes to evaluate on, recorded scans among them.
void add_scene_kind(CLI::App& command, SceneOptions& options);

/// The scenes of the options, of the library's models. Says what of a data set can't be used.
TestSet test_set_of(const SceneOptions& options, const ModelLibrary& library);
/// All that decides the scenes, in one line.
std::string scene_text(const SceneOptions& options);

/// The recipe of any kind but "layout" (and "scans"). Tells people what it chose.
/// @param models  that the scenes will show. @param unit  of the models.
SceneRecipe recipe_of(const SceneOptions& options, const SceneModels& models, Unit unit);

/// The recipe of "layout". @param names  of the models. @param unit  of the models.
LayoutScenes layout_recipe(const SceneOptions& options, std::span<const std::string> names,
                           Unit unit);

/// The sensor of the options and its camera; `camera` is the kind's own.
SensorModel sensor_of(const SceneOptions& options, Unit unit, PinholeCamera& camera);

}  // namespace ostraka::app
