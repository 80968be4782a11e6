// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/io/cloud_file.hpp"
#include "ostraka/library/model_source.hpp"
#include "ostraka/views/model_views.hpp"
#include "ostraka/views/viewpoints.hpp"

namespace ostraka::app {
namespace {

struct ViewsOptions {
    CommonOptions common;
    std::string model;
    std::string output;
    std::string format = "pcd";
    ViewSettings settings;
};

void run_views(ViewsOptions& options) {
    const ModelSource source = load_model(options.model);
    const MeshShape shape = measure(source.mesh);
    ViewSettings& settings = options.settings;
    viewpoints(settings.count);
    if (settings.sampling == 0.0) settings.sampling = 0.01 * shape.diameter;
    settings.rays_per_sample = 1.0;
    const RayScene rays({source.mesh});
    std::error_code problem;
    std::filesystem::create_directories(options.output, problem);
    if (problem) throw FileError(options.output, problem.message());
    const Progress progress = progress_bar();
    Json views = Json::array();
    for (int v = 0; v < settings.count; ++v) {
        const RenderedView view = render_view(rays, shape, settings, v);
        const std::string file = fmt::format("{}_{:04}.{}", source.name, v, options.format);
        write_cloud(std::filesystem::path(options.output) / file, view.cloud);
        views.push_back({{"file", file}, {"T_camera_model", pose_json(view.T_camera_world)}});
        report(progress, "views", static_cast<std::size_t>(v) + 1,
               static_cast<std::size_t>(settings.count));
    }
    const Json json = {{"model", source.name}, {"sampling", settings.sampling}, {"views", views}};
    write_json(json, (std::filesystem::path(options.output) / "views.json").string());
    say(fmt::format("{} views of {}, {:.4g} apart, in {}", settings.count, source.name,
                    settings.sampling, options.output));
    write_json(json, options.common.json);
}

}  // namespace

void add_views(CLI::App& app) {
    auto options = std::make_shared<ViewsOptions>();
    CLI::App* command = app.add_subcommand(
        "views", "export partial clouds of a model, as a depth sensor around it would see them");
    command->add_option("model", options->model, "mesh file: PLY, OBJ, STL, OFF, glTF")->required();
    command->add_option("-o,--output", options->output, "folder to write to")->required();
    command
        ->add_option("--views", options->settings.count,
                     "viewpoints: 12, 20, 42, 80, 162, 320, 642")
        ->capture_default_str();
    command->add_option(
        "--sampling", options->settings.sampling,
        "distance between points at the model's center, in the file's unit (default: "
        "1 % of the diameter)");
    command->add_option("--noise", options->settings.sensor.noise,
                        "standard deviation of the depth, in the file's unit");
    command
        ->add_option("--distance", options->settings.distance,
                     "from the model's center to the sensor, in diameters")
        ->capture_default_str();
    command->add_option("--format", options->format, "pcd (organized), ply or xyz")
        ->capture_default_str()
        ->check(CLI::IsMember({"pcd", "ply", "xyz"}));
    add_common(*command, options->common);
    command->callback([options] { run_views(*options); });
}

}  // namespace ostraka::app
