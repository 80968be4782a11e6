// SPDX-License-Identifier: Apache-2.0
#include "scene_cases.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "ostraka/base/error.hpp"
#include "ostraka/io/data_set.hpp"
#include "ostraka/views/sensor_presets.hpp"

namespace ostraka::bench {
namespace {

constexpr std::string_view kHelp =
    R"(Recognizes whole scenes: Ostraka, Open3D and OpenCV on the same scenes, judged alike.

usage: bench_scenes LIBRARY.ostraka | MESH... [OPTIONS]

  --unit U         of meshes, of which a library is built first: mm, cm, m, in [mm]
  --on KIND        drop, tabletop, random-views: made of the library's models; layout: the poses of
                   a data set; scans: the recorded scans of a data set [drop]
  --scenes N       [6]
  --objects N      in a scene [8 dropped, 4 on a tabletop]
  --noise X        standard deviation of the depth, in the library's unit [0]
  --width N        columns of the depth image [640; the layout's sensor has its own]
  --data DIR       data set (UWA, Bologna, BOP) [$OSTRAKA_DATA/uwa]
  --data-unit U    of a data set that doesn't state its own
  --peers LIST     open3d, opencv, both or none [open3d,opencv]
  --opencv-step X  between OpenCV's points, in model diagonals: finer is better and slower to
                   train [0.04]
  --threads N      of every method; 0: all cores [1]
  --seed N         of the scenes and the methods [0]
  --no-build       don't build the library again to see how long that takes
  --json FILE      also write the table there

Peers are told which models are there and how often, and return as many poses: their precision is
right / returned. "Ostraka" is told nothing; in the row "told" as many of its most confident reports
of each model are judged as there are objects. Objects less than 15 % visible don't count. A pose is
right if its ADI is below 10 % (also 5 %, 2 %) of the model's diameter.
)";

std::map<std::string, std::string SceneCases::*, std::less<>> texts() {
    return {{"--unit", &SceneCases::unit},   {"--on", &SceneCases::on},
            {"--data", &SceneCases::data},   {"--data-unit", &SceneCases::data_unit},
            {"--peers", &SceneCases::peers}, {"--json", &SceneCases::json}};
}

// @return false if there is no such option.
bool set_number(SceneCases& cases, std::string_view key, const std::string& value) {
    if (key == "--scenes") {
        cases.scenes = std::stoi(value);
    } else if (key == "--objects") {
        cases.objects = std::stoi(value);
    } else if (key == "--threads") {
        cases.threads = std::stoi(value);
    } else if (key == "--width") {
        cases.width = std::stoi(value);
    } else if (key == "--noise") {
        cases.noise = std::stod(value);
    } else if (key == "--opencv-step") {
        cases.opencv_step = std::stod(value);
    } else if (key == "--seed") {
        cases.seed = std::stoull(value);
    } else {
        return false;
    }
    return true;
}

void set_value(SceneCases& cases, std::string_view key, const std::string& value) {
    const auto options = texts();
    const auto text = options.find(key);
    if (text != options.end()) {
        cases.*(text->second) = value;
        return;
    }
    try {
        if (set_number(cases, key, value)) return;
    } catch (const std::logic_error&) {
        throw InvalidInput(fmt::format("{}: {} is no number", key, value));
    }
    throw InvalidInput(fmt::format("{}: unknown option, see --help", key));
}

void check_cases(const SceneCases& cases) {
    if (cases.inputs.empty()) throw InvalidInput("a library or meshes are needed, see --help");
    if (cases.scenes < 1) throw InvalidInput("--scenes: at least 1");
    if (cases.threads < 0 || cases.objects < 0 || cases.width < 0 || cases.noise < 0.0) {
        throw InvalidInput("--threads, --objects, --width, --noise: not below 0");
    }
    if (!parse_unit(cases.unit)) throw InvalidInput("--unit: mm, cm, m or in");
}

SensorModel sensor_of(const SceneCases& cases) {
    SensorModel sensor;
    sensor.ranging.noise = cases.noise;
    sensor.ranging.seed = cases.seed;
    return sensor;
}

LayoutScenes layout_recipe(const SceneCases& cases, const DataSet& data,
                           const ModelLibrary& library) {
    const Unit unit = library.settings.unit;
    const std::optional<Unit> from = data.unit ? data.unit : parse_unit(cases.data_unit);
    if (!from) throw InvalidInput("--data-unit: the data set doesn't state its unit");
    std::vector<std::string> names;
    for (const Model& model : library.models) names.push_back(model.name);
    LayoutScenes recipe{layout_of(data, names, unit_factor(*from, unit), nullptr),
                        layout_camera(data)};
    recipe.camera = resized(find_sensor_preset("laser-line", unit)->camera, cases.width);
    recipe.sensor = sensor_of(cases);
    return recipe;
}

SceneRecipe made_recipe(const SceneCases& cases) {
    if (cases.on == "drop") {
        DropScenes recipe{.seed = cases.seed};
        if (cases.objects > 0) recipe.objects = cases.objects;
        // As much room for each object, however many there are.
        recipe.drop.area = 0.8 * std::sqrt(static_cast<double>(recipe.objects));
        recipe.camera = resized(recipe.camera, cases.width);
        recipe.sensor = sensor_of(cases);
        return recipe;
    }
    if (cases.on == "tabletop") {
        TabletopScenes recipe{
            {.objects = cases.objects > 0 ? cases.objects : 4, .spacing = 0.9, .seed = cases.seed}};
        recipe.settings.camera = resized(recipe.settings.camera, cases.width);
        recipe.settings.sensor = sensor_of(cases);
        return recipe;
    }
    if (cases.on != "random-views") throw InvalidInput("--on: no such kind, see --help");
    RandomViewSettings recipe{.seed = cases.seed};
    recipe.camera = resized(recipe.camera, cases.width);
    recipe.sensor = sensor_of(cases);
    return recipe;
}

}  // namespace

std::string_view scene_cases_help() {
    return kHelp;
}

SceneCases parse_scene_cases(int count, char** arguments) {
    SceneCases cases;
    if (const char* data = std::getenv("OSTRAKA_DATA")) {
        cases.data = (std::filesystem::path(data) / "uwa").string();
    }
    for (int i = 1; i < count; ++i) {
        const std::string_view key = arguments[i];
        if (key == "--help" || key == "-h") {
            cases.help = true;
            return cases;
        }
        if (key == "--no-build") {
            cases.time_build = false;
        } else if (!key.starts_with("--")) {
            cases.inputs.emplace_back(key);
        } else if (i + 1 == count) {
            throw InvalidInput(fmt::format("{}: unknown, or without a value", key));
        } else {
            set_value(cases, key, arguments[++i]);
        }
    }
    check_cases(cases);
    return cases;
}

TestSet test_set_of(const SceneCases& cases, const ModelLibrary& library) {
    const auto count = static_cast<std::size_t>(cases.scenes);
    const bool recorded = cases.on == "scans";
    if (!recorded && cases.on != "layout") return simulated_set(library, made_recipe(cases), count);
    if (cases.data.empty()) throw InvalidInput("--data or OSTRAKA_DATA: which data set?");
    const DataSet data = open_data_set(cases.data);
    if (!recorded) return simulated_set(library, layout_recipe(cases, data, library), count);
    TestSet set = recorded_set(data, library, parse_unit(cases.data_unit));
    set.count = std::min(set.count, count);
    return set;
}

std::string scene_text(const SceneCases& cases) {
    std::string text = fmt::format("{} x {}", cases.scenes, cases.on);
    if (cases.on == "layout" || cases.on == "scans") {
        // The folder's place on this machine is nobody else's business.
        text +=
            ", data " + std::filesystem::path(cases.data).lexically_normal().filename().string();
    }
    if (cases.objects > 0) text += fmt::format(", objects {}", cases.objects);
    if (cases.width > 0) text += fmt::format(", width {}", cases.width);
    return text + fmt::format(", noise {:g}, seed {}", cases.noise, cases.seed);
}

}  // namespace ostraka::bench
