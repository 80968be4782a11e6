// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <mutex>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/io/bop_writer.hpp"
#include "ostraka/io/cloud_file.hpp"
#include "ostraka/io/depth_camera.hpp"
#include "ostraka/library/model_source.hpp"
#include "scene_options.hpp"

namespace ostraka::app {
namespace {

struct SimulateOptions {
    CommonOptions common;
    std::vector<std::string> models;
    std::string output;
    std::string unit;
    std::string format = "pcd";
    SceneOptions scenes;
};

// Steps of the depth images: 0.1 mm reaches 6.5 m.
constexpr double kDepthStepMillimeters = 0.1;

Json truth_json(const SimulatedScene& scene, const std::vector<std::string>& names,
                const std::string& file, const std::string& unit) {
    Json objects = Json::array();
    for (const TrueObject& object : scene.objects) {
        objects.push_back({{"model", names[object.model]},
                           {"T_scene_model", pose_json(object.T_scene_model)},
                           {"visible_fraction", object.visible_fraction}});
    }
    return {{"scene", file}, {"unit", unit}, {"objects", objects}};
}

// Writes one scene after the other in one of the formats.
class SceneWriter {
  public:
    SceneWriter(const SimulateOptions& options, const SceneModels& models,
                const std::vector<std::string>& names, Unit unit)
        : options_(options), names_(names), unit_(unit) {
        if (options.format != "bop") {
            std::error_code problem;
            std::filesystem::create_directories(options.output, problem);
            if (problem) throw FileError(options.output, problem.message());
            return;
        }
        std::vector<BopModel> bop(names.size());
        parallel_for(names.size(), [&](std::size_t i) {
            bop[i] = {names[i], models.meshes[i], find_symmetry(models.meshes[i])};
        });
        bop_ = std::make_unique<BopWriter>(options.output, bop, unit,
                                           BopWriterSettings{.depth_scale = kDepthStepMillimeters});
    }

    /// Safe from many threads. @return the truth as it is written.
    Json write(std::size_t number, const SimulatedScene& scene) {
        const std::string stem = fmt::format("scene_{:04}", number);
        const bool depth = options_.format == "depth";
        const std::string file = stem + "." + (depth ? "png" : options_.format);
        const Json truth = truth_json(scene, names_, file, std::string(unit_name(unit_)));
        if (bop_) {
            bop_->write(number, bop_image(scene));
            return truth;
        }
        const std::filesystem::path folder(options_.output);
        if (depth) {
            write_depth(folder / file, scene);
        } else {
            write_cloud(folder / file, scene.cloud);
        }
        write_json(truth, (folder / (stem + ".json")).string());
        return truth;
    }

    void finish(const PinholeCamera& camera) {
        if (bop_) bop_->finish();
        if (options_.format != "depth") return;
        write_camera_json(std::filesystem::path(options_.output) / "camera.json",
                          {camera, depth_step(), unit_});
    }

  private:
    double depth_step() const {
        return kDepthStepMillimeters * unit_factor(Unit::millimeter, unit_);
    }

    void write_depth(const std::filesystem::path& path, const SimulatedScene& scene) const {
        std::vector<std::uint16_t> values(scene.cloud.size(), 0);
        const double step = depth_step();
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double depth = double{scene.cloud.points[i].z()} / step;
            if (depth > 65535.0) {
                throw InvalidInput(
                    fmt::format("{}: a depth is beyond {:.4g} {}, the reach of a "
                                "depth image; choose another --format",
                                path.string(), 65535.0 * step, unit_name(unit_)));
            }
            if (depth > 0.0) values[i] = static_cast<std::uint16_t>(std::lround(depth));
        }
        write_depth_png16(path, scene.camera.width, scene.camera.height, values);
    }

    BopImage bop_image(const SimulatedScene& scene) const {
        const double factor = unit_factor(unit_, Unit::millimeter);
        BopImage image{.camera = scene.camera};
        image.depth.assign(scene.cloud.size(), 0.0F);
        for (std::size_t i = 0; i < scene.cloud.size(); ++i) {
            const float depth = scene.cloud.points[i].z();
            if (depth > 0.0F) image.depth[i] = static_cast<float>(double{depth} * factor);
        }
        for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
            BopObject object{.number = static_cast<int>(scene.objects[o].model) + 1,
                             .T_camera_model = scene.objects[o].T_scene_model};
            object.T_camera_model.translation() *= factor;
            image.objects.push_back(object);
            BopMasks masks{std::vector<std::uint8_t>(scene.cloud.size(), 0),
                           std::vector<std::uint8_t>(scene.cloud.size(), 0)};
            for (const std::uint32_t pixel : scene.silhouettes[o]) {
                masks.all[pixel] = 255;
                if (scene.visible[pixel] == o) masks.visible[pixel] = 255;
            }
            image.masks.push_back(std::move(masks));
        }
        measure_masks(image);
        // The whole silhouette counts, also beyond the image's border.
        for (std::size_t o = 0; o < scene.objects.size(); ++o) {
            image.objects[o].pixels_all = static_cast<int>(scene.objects[o].pixels_total);
            image.objects[o].visible_fraction = scene.objects[o].visible_fraction;
        }
        return image;
    }

    const SimulateOptions& options_;
    const std::vector<std::string>& names_;
    Unit unit_;
    std::unique_ptr<BopWriter> bop_;
};

SceneRecipe chosen_recipe(const SceneOptions& options, const SceneModels& models,
                          const std::vector<std::string>& names, Unit unit) {
    if (options.kind == "layout") return layout_recipe(options, names, unit);
    return recipe_of(options, models, unit);
}

void run_simulate(const SimulateOptions& options) {
    catch_interrupts();
    std::vector<std::string> names;
    std::vector<TriangleMesh> meshes;
    for (const std::string& path : options.models) {
        ModelSource source = load_model(path);
        names.push_back(source.name);
        meshes.push_back(std::move(source.mesh));
    }
    const Unit unit = require_unit(options.unit, "the scans are written in the models' unit");
    SceneModels models = scene_models(std::move(meshes));
    const SceneRecipe recipe = chosen_recipe(options.scenes, models, names, unit);
    const SceneSimulator simulator(std::move(models), recipe);
    SceneWriter writer(options, simulator.models(), names, unit);
    const Progress progress = progress_bar();
    const std::size_t count =
        std::min(static_cast<std::size_t>(options.scenes.scenes), simulator.limit());
    std::vector<Json> truths(count);
    std::mutex mutex;
    std::size_t done = 0;
    PinholeCamera camera;
    parallel_for(count, [&](std::size_t i) {
        const SimulatedScene scene = simulator.make(i);
        truths[i] = writer.write(i, scene);
        const std::scoped_lock lock(mutex);
        camera = scene.camera;
        report(progress, "scenes", ++done, count);
    });
    writer.finish(camera);
    say(fmt::format("{} scenes with ground truth in {}", count, options.output));
    write_json({{"scenes", truths}}, options.common.json);
}

}  // namespace

void add_simulate(CLI::App& app) {
    auto options = std::make_shared<SimulateOptions>();
    options->scenes.scenes = 10;
    CLI::App* command = app.add_subcommand("simulate", "make scans with ground truth from models");
    command->add_option("kind", options->scenes.kind, scene_kinds_help())
        ->required()
        ->check(CLI::IsMember({"tabletop", "drop", "bin", "random-views", "layout"}));
    command->add_option("models", options->models, "mesh files: PLY, OBJ, STL, OFF, glTF")
        ->required();
    command->add_option("-o,--output", options->output, "folder to write to")->required();
    add_unit(*command, options->unit, "unit of the numbers in the model files, and of the scans");
    command
        ->add_option("--format", options->format,
                     "pcd (organized), ply or xyz clouds; depth: 16-bit PNG with camera.json; bop: "
                     "a data set in BOP's layout, with masks")
        ->capture_default_str()
        ->check(CLI::IsMember({"pcd", "ply", "xyz", "depth", "bop"}));
    add_scene_options(*command, options->scenes, "--unit");
    add_scene_noise(*command, options->scenes, "--unit");
    add_common(*command, options->common);
    command->callback([options] { run_simulate(*options); });
}

}  // namespace ostraka::app
