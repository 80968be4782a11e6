// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <set>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/io/models_info.hpp"
#include "ostraka/library/model_source.hpp"
#include "ostraka/library/model_surface.hpp"
#include "ostraka/mesh/symmetry_poses.hpp"
#include "ostraka/views/model_views.hpp"

namespace ostraka::app {
namespace {

struct SymmetryOptions {
    CommonOptions common;
    std::vector<std::string> models;
    std::string unit;
    std::string output;
    bool outside = false;
    SymmetrySettings settings;
};

// A model, what was found, and how long that took.
struct Row {
    ModelSource source;
    Symmetry symmetry;
    double milliseconds = 0.0;
};

// What can be seen of a model from 42 directions.
Symmetry symmetry_from_outside(const TriangleMesh& mesh, const SymmetrySettings& settings) {
    const MeshShape shape = measure(mesh);
    ViewSettings views;
    views.sampling = 0.01 * shape.diameter;
    const RayScene rays({mesh});
    std::vector<RenderedView> rendered;
    for (int v = 0; v < views.count; ++v) {
        rendered.push_back(render_view(rays, shape, views, v));
    }
    return find_symmetry(merge_surface(rendered, views.sampling), shape.diameter, settings);
}

Row examine(const std::string& path, const SymmetryOptions& options) {
    Row row{.source = load_model(path)};
    const Stopwatch watch;
    row.symmetry = options.outside ? symmetry_from_outside(row.source.mesh, options.settings)
                                   : find_symmetry(row.source.mesh, options.settings);
    row.milliseconds = 1e3 * watch.seconds();
    return row;
}

Json vector_json(const Vec3d& vector) {
    return {vector.x(), vector.y(), vector.z()};
}

Json symmetry_json(const Row& row) {
    Json turns = Json::array();
    for (const Pose& turn : row.symmetry.turns) turns.push_back(pose_json(turn));
    Json axes = Json::array();
    for (const ContinuousAxis& axis : row.symmetry.axes) {
        axes.push_back(
            {{"direction", vector_json(axis.direction)}, {"point", vector_json(axis.point)}});
    }
    return {{"model", row.source.name},
            {"file", row.source.file},
            {"group", symmetry_name(row.symmetry)},
            {"symmetry", describe_symmetry(row.symmetry)},
            {"center", vector_json(row.symmetry.center)},
            {"T_model_model", turns},
            {"axes", axes},
            {"milliseconds", row.milliseconds}};
}

void run_symmetry(const SymmetryOptions& options) {
    const Unit unit = require_unit(options.unit, "a symmetry's centers and BOP's file are lengths");
    const Progress progress = progress_bar();
    Json models = Json::array();
    std::vector<ModelInfo> infos;
    std::set<std::string> names;
    std::vector<std::vector<std::string>> table = {{"model", "group", "ms", "symmetry"}};
    for (const std::string& path : options.models) {
        const Row row = examine(path, options);
        if (!names.insert(row.source.name).second) {
            throw InvalidInput(fmt::format("two models are named {}", row.source.name));
        }
        models.push_back(symmetry_json(row));
        infos.push_back(model_info(static_cast<int>(infos.size()) + 1, row.source.name,
                                   row.source.mesh, row.symmetry, unit));
        table.push_back({row.source.name, symmetry_name(row.symmetry),
                         fmt::format("{:.0f}", row.milliseconds), describe_symmetry(row.symmetry)});
        report(progress, "symmetry", infos.size(), options.models.size());
    }
    say_table(table);
    if (!options.output.empty()) write_models_info(options.output, infos);
    write_json(
        {{"unit", unit_name(unit)}, {"tolerance", options.settings.tolerance}, {"models", models}},
        options.common.json);
}

}  // namespace

void add_symmetry(CLI::App& app) {
    auto options = std::make_shared<SymmetryOptions>();
    CLI::App* command = app.add_subcommand(
        "symmetry", "find the turns that map each model onto itself, and write models_info.json");
    command->add_option("models", options->models, "mesh files: PLY, OBJ, STL, OFF, glTF")
        ->required();
    add_unit(*command, options->unit, "unit of the numbers in the model files");
    command
        ->add_option("--tolerance", options->settings.tolerance,
                     "how far a turned surface may be from itself, as a share of the diameter; at "
                     "most 0.05")
        ->capture_default_str();
    command
        ->add_option("--samples", options->settings.samples,
                     "points that represent a surface; more see smaller holes in thin plates")
        ->capture_default_str();
    command->add_flag("--outside", options->outside,
                      "judge only what can be seen from outside (for CAD models with inner faces "
                      "or wound at random; slower)");
    command->add_option("-o,--output", options->output,
                        "write sizes and symmetries in the form of BOP's models_info.json, in mm, "
                        "numbered from 1 in the order given");
    add_common(*command, options->common);
    command->callback([options] { run_symmetry(*options); });
}

}  // namespace ostraka::app
