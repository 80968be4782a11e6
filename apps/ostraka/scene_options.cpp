// SPDX-License-Identifier: Apache-2.0
#include "scene_options.hpp"

#include <fmt/format.h>

#include "ostraka/base/error.hpp"
#include "ostraka/io/data_set.hpp"

namespace ostraka::app {
namespace {

std::string sensor_names() {
    std::string names;
    for (const SensorPreset& preset : sensor_presets(Unit::millimeter)) {
        names +=
            fmt::format("{}{}: {}", names.empty() ? "" : "; ", preset.name, preset.description);
    }
    return names;
}

// From the sensor, in mean diameters: as asked for, or so that the sensor's image shows as much as
// the kind's own camera does at the kind's own distance, and within the sensor's range.
double distance_in_diameters(const SceneOptions& options, double own, const PinholeCamera& before,
                             const PinholeCamera& after, const SensorModel& sensor,
                             double diameter) {
    if (options.distance > 0.0) return options.distance / diameter;
    const auto narrowness = [](const PinholeCamera& camera) {
        return std::max(camera.fx / camera.width, camera.fy / camera.height);
    };
    const double zoom = narrowness(after) / narrowness(before);
    return std::max(own * zoom, 1.3 * sensor.min_depth / diameter);
}

std::optional<ModelChoice> choice_of(const SceneOptions& options) {
    if (options.choice.empty()) return std::nullopt;
    return options.choice == "turns" ? ModelChoice::in_turns : ModelChoice::random;
}

BinSettings bin_of(const SceneOptions& options, double diameter) {
    const BinSettings usual = usual_bin(diameter);
    if (options.bin.empty()) return usual;
    const std::vector<double> sides = parse_numbers(options.bin, "--bin");
    if (sides.size() != 3) throw CLI::ValidationError("--bin", "needs length,width,height");
    BinSettings bin{sides[0], sides[1], sides[2], usual.wall};
    check(bin);
    return bin;
}

DropScenes drop_recipe(const SceneOptions& options, const SceneModels& models, Unit unit) {
    DropScenes recipe{.seed = options.seed};
    const bool in_bin = options.kind == "bin";
    const double diameter = mean_diameter(models);
    recipe.objects = options.objects > 0 ? options.objects : in_bin ? 15 : 8;
    recipe.choice = choice_of(options).value_or(ModelChoice::in_turns);
    if (in_bin) {
        recipe.drop.bin = bin_of(options, diameter);
        recipe.min_elevation = 1.1;
        recipe.max_elevation = 1.5;
    } else {
        // As much room for each object, however many there are.
        recipe.drop.area = 0.8 * std::sqrt(static_cast<double>(recipe.objects));
    }
    const PinholeCamera own = recipe.camera;
    recipe.sensor = sensor_of(options, unit, recipe.camera);
    recipe.distance = distance_in_diameters(options, recipe.distance, own, recipe.camera,
                                            recipe.sensor, diameter);
    return recipe;
}

TabletopScenes tabletop_recipe(const SceneOptions& options, const SceneModels& models, Unit unit) {
    TabletopScenes recipe{{.objects = options.objects > 0 ? options.objects : 4,
                           .spacing = options.spacing,
                           .seed = options.seed},
                          choice_of(options).value_or(ModelChoice::random)};
    const PinholeCamera own = recipe.settings.camera;
    recipe.settings.sensor = sensor_of(options, unit, recipe.settings.camera);
    recipe.settings.distance =
        distance_in_diameters(options, recipe.settings.distance, own, recipe.settings.camera,
                              recipe.settings.sensor, mean_diameter(models));
    return recipe;
}

}  // namespace

std::string scene_kinds_help() {
    return "tabletop: objects standing on a table in a grid; drop: objects dropped on a table; "
           "bin: "
           "objects dropped into a bin; random-views: 3 to 5 objects hiding each other, no table; "
           "layout: the poses of a data set (--data)";
}

void add_scene_options(CLI::App& command, SceneOptions& options, const std::string& unit) {
    command
        .add_option("--scenes", options.scenes, "scenes to make; a layout has as many as it has")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000000));
    command
        .add_option("--objects", options.objects,
                    "objects in a scene (default: 4 on a tabletop, 8 dropped, 15 in a bin)")
        ->check(CLI::Range(1, 100000));
    command
        .add_option("--models-in", options.choice,
                    "random: models are drawn; turns: each has its turn (default: turns where "
                    "objects are dropped, else random)")
        ->check(CLI::IsMember({"random", "turns"}));
    command.add_option("--sensor", options.sensor, "kind of depth camera: " + sensor_names())
        ->check([](const std::string& name) {
            return find_sensor_preset(name, Unit::millimeter)
                       ? std::string()
                       : "no sensor is called " + name + "; there are: " + sensor_names();
        });
    command
        .add_option("--distance", options.distance,
                    "from the sensor to the middle of the scene, in " + unit +
                        " (default: so that the scene fills the image)")
        ->check(CLI::PositiveNumber);
    command
        .add_option("--width", options.width,
                    "columns of the depth image; the field of view stays (default: the camera's "
                    "own)")
        ->check(CLI::Range(16, 8192));
    command
        .add_option("--spacing", options.spacing,
                    "between neighbors on a tabletop, in mean diameters")
        ->capture_default_str();
    command.add_option("--bin", options.bin,
                       "inside of a bin: length,width,height in " + unit +
                           " (default: 2.6 x 1.8 x 0.9 mean diameters)");
    command.add_option("--data", options.data,
                       "folder of a data set (UWA, Bologna, BOP, or made by `ostraka simulate`)");
    command
        .add_option("--data-unit", options.data_unit, "unit of a data set that doesn't state it")
        ->check(CLI::IsMember({"mm", "cm", "m", "in"}));
    command.add_option("--seed", options.seed, "seed of every random step")->capture_default_str();
}

void add_scene_noise(CLI::App& command, SceneOptions& options, const std::string& unit) {
    command
        .add_option("--noise", options.noise,
                    "standard deviation of the depth, in " + unit + ", added to the sensor's own")
        ->capture_default_str()
        ->check(CLI::NonNegativeNumber);
}

void add_scene_kind(CLI::App& command, SceneOptions& options) {
    command
        .add_option("--on", options.kind,
                    "scenes to evaluate on. Simulated from the library's models: " +
                        scene_kinds_help() + ". scans: the recorded scans of a data set (--data)")
        ->capture_default_str()
        ->check(CLI::IsMember({"tabletop", "drop", "bin", "random-views", "layout", "scans"}));
}

TestSet test_set_of(const SceneOptions& options, const ModelLibrary& library) {
    TestSet set;
    const auto count = static_cast<std::size_t>(options.scenes);
    if (options.kind == "scans") {
        if (options.data.empty()) {
            throw CLI::ValidationError("--data", "scans need the folder of a data set");
        }
        set = recorded_set(open_data_set(options.data), library, parse_unit(options.data_unit));
        for (const std::string& note : set.notes) say(note);
        set.count = std::min(set.count, count);
    } else if (options.kind == "layout") {
        std::vector<std::string> names;
        for (const Model& model : library.models) names.push_back(model.name);
        set = simulated_set(library, layout_recipe(options, names, library.settings.unit), count);
    } else {
        const SceneRecipe recipe =
            recipe_of(options, scene_models_of(library), library.settings.unit);
        set = simulated_set(library, recipe, count);
    }
    set.description = scene_text(options);
    return set;
}

std::string scene_text(const SceneOptions& options) {
    std::string text = fmt::format("{} x {}", options.scenes, options.kind);
    const auto add = [&](const char* name, const std::string& value) {
        if (!value.empty()) text += fmt::format(", {} {}", name, value);
    };
    const auto number = [](double value) {
        return value == 0.0 ? std::string() : fmt::format("{:g}", value);
    };
    // The folder's place on this machine is nobody else's business.
    add("data", std::filesystem::path(options.data).lexically_normal().filename().string());
    add("sensor", options.sensor);
    add("objects", number(options.objects));
    add("models in", options.choice);
    add("noise", number(options.noise));
    add("distance", number(options.distance));
    add("width", number(options.width));
    if (options.kind == "tabletop") add("spacing", number(options.spacing));
    add("bin", options.bin);
    add("seed", fmt::format("{}", options.seed));
    return text;
}

SensorModel sensor_of(const SceneOptions& options, Unit unit, PinholeCamera& camera) {
    SensorModel sensor;
    if (!options.sensor.empty()) {
        const auto preset = find_sensor_preset(options.sensor, unit);
        sensor = preset->model;
        camera = preset->camera;
    }
    camera = resized(camera, options.width);
    sensor.ranging.noise += options.noise;
    sensor.ranging.seed = options.seed;
    return sensor;
}

SceneRecipe recipe_of(const SceneOptions& options, const SceneModels& models, Unit unit) {
    if (options.kind == "tabletop") return tabletop_recipe(options, models, unit);
    if (options.kind == "drop" || options.kind == "bin") return drop_recipe(options, models, unit);
    RandomViewSettings recipe{.seed = options.seed};
    const PinholeCamera own = recipe.camera;
    recipe.sensor = sensor_of(options, unit, recipe.camera);
    recipe.distance = distance_in_diameters(options, recipe.distance, own, recipe.camera,
                                            recipe.sensor, mean_diameter(models));
    return recipe;
}

LayoutScenes layout_recipe(const SceneOptions& options, std::span<const std::string> names,
                           Unit unit) {
    if (options.data.empty()) {
        throw CLI::ValidationError("--data", "a layout needs the folder of a data set");
    }
    const DataSet data = open_data_set(options.data);
    const std::optional<Unit> from = data.unit ? data.unit : parse_unit(options.data_unit);
    if (!from) throw CLI::ValidationError("--data-unit", "the data set doesn't state its unit");
    std::vector<std::string> notes;
    LayoutScenes recipe{layout_of(data, names, unit_factor(*from, unit), &notes),
                        layout_camera(data)};
    for (const std::string& note : notes) say(note);
    SceneOptions own = options;
    if (own.sensor.empty()) own.sensor = "laser-line";
    recipe.sensor = sensor_of(own, unit, recipe.camera);
    if (options.sensor.empty()) {
        // Its optics only: faults are asked for by name.
        recipe.sensor = SensorModel{};
        recipe.sensor.ranging.noise = options.noise;
        recipe.sensor.ranging.seed = options.seed;
    }
    return recipe;
}

}  // namespace ostraka::app
