// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <numeric>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/random.hpp"
#include "ostraka/io/cloud_file.hpp"
#include "ostraka/library/model_source.hpp"
#include "ostraka/simulation/scene.hpp"

namespace ostraka::app {
namespace {

struct SimulateOptions {
    CommonOptions common;
    std::string kind;
    std::vector<std::string> models;
    std::string output;
    std::string unit;
    std::string format = "pcd";
    int scenes = 10;
    int objects = 4;
    int width = 0;  // of the image; 0: the scene kind's own
    double noise = 0.0;
    double spacing = 0.9;
    std::uint64_t seed = 0;
};

// A camera with the given one's field of view and another number of pixels.
PinholeCamera resized(PinholeCamera camera, int width) {
    if (width == 0) return camera;
    const double factor = static_cast<double>(width) / camera.width;
    camera.height = static_cast<int>(camera.height * factor);
    camera.width = width;
    camera.fx *= factor;
    camera.fy *= factor;
    camera.cx = (camera.width - 1) / 2.0;
    camera.cy = (camera.height - 1) / 2.0;
    return camera;
}

SimulatedScene make_scene(const SceneModels& models, std::uint64_t number,
                          const SimulateOptions& options) {
    if (options.kind == "random-views") {
        RandomViewSettings settings{.seed = options.seed};
        settings.camera = resized(settings.camera, options.width);
        settings.sensor.ranging = {.noise = options.noise, .seed = options.seed};
        return simulate_random_view(models, number, settings);
    }
    TabletopSettings settings{
        .objects = options.objects, .spacing = options.spacing, .seed = options.seed};
    settings.camera = resized(settings.camera, options.width);
    settings.sensor.ranging = {.noise = options.noise, .seed = options.seed};
    Random random(options.seed ^ 0x7ab1e, number);
    std::vector<std::uint32_t> chosen;
    for (int i = 0; i < options.objects; ++i) {
        chosen.push_back(random.below(static_cast<std::uint32_t>(models.meshes.size())));
    }
    return simulate_tabletop(models, chosen, number, settings);
}

Json truth_json(const SimulatedScene& scene, const std::vector<ModelSource>& models,
                const std::string& file, const std::string& unit) {
    Json objects = Json::array();
    for (const TrueObject& object : scene.objects) {
        objects.push_back({{"model", models[object.model].name},
                           {"T_scene_model", pose_json(object.T_scene_model)},
                           {"visible_fraction", object.visible_fraction}});
    }
    return {{"scene", file}, {"unit", unit}, {"objects", objects}};
}

void run_simulate(const SimulateOptions& options) {
    catch_interrupts();
    std::vector<ModelSource> models;
    std::vector<TriangleMesh> meshes;
    for (const std::string& path : options.models) {
        models.push_back(load_model(path));
        meshes.push_back(models.back().mesh);
    }
    const SceneModels scene_set = scene_models(std::move(meshes));
    const Unit unit = require_unit(options.unit, "the scans are written in the models' unit");
    std::error_code problem;
    std::filesystem::create_directories(options.output, problem);
    if (problem) throw FileError(options.output, problem.message());
    const Progress progress = progress_bar();
    Json scenes = Json::array();
    for (int i = 0; i < options.scenes; ++i) {
        const SimulatedScene scene = make_scene(scene_set, static_cast<std::uint64_t>(i), options);
        const std::string stem = fmt::format("scene_{:04}", i);
        const std::string file = stem + "." + options.format;
        write_cloud(std::filesystem::path(options.output) / file, scene.cloud);
        const Json truth = truth_json(scene, models, file, std::string(unit_name(unit)));
        write_json(truth, (std::filesystem::path(options.output) / (stem + ".json")).string());
        scenes.push_back(truth);
        report(progress, "scenes", static_cast<std::size_t>(i) + 1,
               static_cast<std::size_t>(options.scenes));
    }
    say(fmt::format("{} scenes with ground truth in {}", options.scenes, options.output));
    write_json({{"scenes", scenes}}, options.common.json);
}

}  // namespace

void add_simulate(CLI::App& app) {
    auto options = std::make_shared<SimulateOptions>();
    CLI::App* command = app.add_subcommand("simulate", "make scans with ground truth from models");
    command
        ->add_option(
            "kind", options->kind,
            "tabletop: objects standing on a table; random-views: 3 to 5 objects hiding each "
            "other, no table")
        ->required()
        ->check(CLI::IsMember({"tabletop", "random-views"}));
    command->add_option("models", options->models, "mesh files: PLY, OBJ, STL, OFF, glTF")
        ->required();
    command->add_option("-o,--output", options->output, "folder to write to")->required();
    add_unit(*command, options->unit, "unit of the numbers in the model files, and of the scans");
    command->add_option("--scenes", options->scenes, "scans to make")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000000));
    command->add_option("--objects", options->objects, "objects in a tabletop scene")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000000));
    command
        ->add_option("--spacing", options->spacing,
                     "between neighbors on the table, in mean diameters")
        ->capture_default_str();
    command->add_option("--noise", options->noise, "standard deviation of the depth, in --unit")
        ->capture_default_str();
    command
        ->add_option("--width", options->width,
                     "columns of the depth image; the field of view stays (default: 640 for "
                     "tabletop, 1280 for random-views)")
        ->check(CLI::Range(16, 8192));
    command->add_option("--format", options->format, "pcd (organized), ply or xyz")
        ->capture_default_str()
        ->check(CLI::IsMember({"pcd", "ply", "xyz"}));
    command->add_option("--seed", options->seed, "seed of every random step")
        ->capture_default_str();
    add_common(*command, options->common);
    command->callback([options] { run_simulate(*options); });
}

}  // namespace ostraka::app
