// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <sstream>

#include "commands.hpp"
#include "common.hpp"
#include "explain_page.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/io/cloud_file.hpp"
#include "ostraka/io/png_file.hpp"
#include "ostraka/library/library_file.hpp"
#include "ostraka/mesh/symmetry_poses.hpp"
#include "ostraka/recognition/picture.hpp"
#include "ostraka/recognition/recognize.hpp"

namespace ostraka::app {
namespace {

struct RecognizeOptions {
    CommonOptions common;
    std::string library;
    std::string scene;
    std::string unit;
    std::string viewpoint;
    std::string overlay;
    std::string picture;
    std::string explain;
    std::string only;
    RecognitionSettings settings;
};

constexpr int kAxisSteps = 12;  // equivalent poses listed for each continuous axis

Json features_json(const Features& features) {
    Json json = Json::object();
    for (std::size_t i = 0; i < kFeatures; ++i) {
        json[std::string(feature_name(static_cast<Feature>(i)))] = features[i];
    }
    return json;
}

// Every pose that shows the same surface, the reported one first; one if there is no symmetry.
Json equivalents_json(const ModelLibrary& library, const RecognizedObject& object, double factor) {
    Json poses = Json::array();
    for (const Model& model : library.models) {
        if (model.name != object.model) continue;
        for (const Pose& pose :
             equivalent_poses(model.symmetry, object.T_scene_model, kAxisSteps)) {
            poses.push_back(pose_json(pose, factor));
        }
    }
    return poses;
}

Json recognition_json(const ModelLibrary& library, const Recognition& result,
                      const std::string& scene, Unit unit, double factor) {
    Json objects = Json::array();
    for (const RecognizedObject& object : result.objects) {
        objects.push_back({{"model", object.model},
                           {"T_scene_model", pose_json(object.T_scene_model, factor)},
                           {"equivalent_poses", equivalents_json(library, object, factor)},
                           {"confidence", object.confidence},
                           {"visible_fraction", object.visible_fraction},
                           {"inlier_rms", object.inlier_rms * factor},
                           {"source", object.source},
                           {"round", object.round},
                           {"rival", object.rival},
                           {"features", features_json(object.features)}});
    }
    Json seconds = Json::object();
    for (const auto& [stage, time] : result.seconds) seconds[stage] = time;
    return {{"scene", scene},
            {"unit", unit_name(unit)},
            {"objects", objects},
            {"out_of_time", result.out_of_time},
            {"seconds", seconds}};
}

// "crank, flange" as indices of models.
std::vector<std::uint32_t> parse_models(const std::string& names, const ModelLibrary& library) {
    std::vector<std::uint32_t> models;
    std::istringstream list(names);
    for (std::string name; std::getline(list >> std::ws, name, ',');) {
        name.erase(name.find_last_not_of(" \t") + 1);
        const auto at = std::find_if(library.models.begin(), library.models.end(),
                                     [&](const Model& model) { return model.name == name; });
        if (at == library.models.end()) {
            std::string known;
            for (const Model& model : library.models) known += " " + model.name;
            throw InvalidInput(
                fmt::format("--only: the library has no model \"{}\"; it has{}", name, known));
        }
        models.push_back(static_cast<std::uint32_t>(at - library.models.begin()));
    }
    if (models.empty()) throw InvalidInput("--only: no model is named");
    return models;
}

void say_result(const Recognition& result, const RecognitionSettings& settings, Unit unit,
                double factor) {
    std::vector<std::vector<std::string>> rows = {
        {"model", "confidence", "visible", fmt::format("rms {}", unit_name(unit)), "source"}};
    for (const RecognizedObject& object : result.objects) {
        rows.push_back({object.model, fmt::format("{:.3f}", object.confidence),
                        fmt::format("{:.2f}", object.visible_fraction),
                        fmt::format("{:.3g}", object.inlier_rms * factor), object.source});
    }
    say_table(rows);
    std::string times;
    for (const auto& [stage, time] : result.seconds)
        times += fmt::format(" {} {:.3f}", stage, time);
    say("seconds:" + times);
    if (result.out_of_time) {
        say("the time limit ended the search: what is best so far is reported");
    }
    if (result.objects.empty()) {
        say(fmt::format("no object of the library found with confidence {:g} or more",
                        settings.min_confidence));
    }
}

void write_pictures(const RecognizeOptions& options, const PointCloud& scene,
                    const ModelLibrary& library, const Recognition& result, double factor) {
    if (!options.overlay.empty()) {
        write_cloud(options.overlay, scaled(overlay_cloud(scene, library, result), factor));
        say("overlay: " + options.overlay);
    }
    if (!options.picture.empty()) {
        write_png(options.picture, draw_recognition(scene, library, result));
        say("picture: " + options.picture);
    }
    if (!options.explain.empty()) {
        const auto name = [](const std::string& path) {
            return std::filesystem::path(path).filename().string();
        };
        write_text(explain_page({library, scene, result, options.settings, name(options.scene),
                                 name(options.library)}),
                   options.explain);
        say("explanation: " + options.explain);
    }
}

// "unknown", one viewpoint, or several of a merged scan, separated by semicolons.
// @param factor  from the scan's unit to the library's.
void set_viewpoints(const std::string& text, double factor, PointCloud& cloud,
                    RecognitionSettings& settings) {
    if (text == "unknown") {
        settings.viewpoint_known = false;
        say("the viewpoint is unknown: free space can't contradict, so more may be reported "
            "wrongly");
        return;
    }
    if (text.find(';') == std::string::npos) {
        if (const auto viewpoint = parse_viewpoint(text)) cloud.viewpoint = *viewpoint;
        return;
    }
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ';');) {
        const auto viewpoint = parse_viewpoint(part);
        if (!viewpoint) throw CLI::ValidationError("--viewpoint", "one of them is empty");
        settings.viewpoints.push_back(*viewpoint * static_cast<float>(factor));
    }
}

void run_recognize(const RecognizeOptions& options) {
    Stopwatch watch;
    const ModelLibrary library = load_library(options.library);
    RecognitionSettings settings = options.settings;
    if (!options.only.empty()) settings.only = parse_models(options.only, library);
    settings.keep_candidates = !options.explain.empty();
    const Recognizer recognizer(library);
    const double load_seconds = watch.lap();
    CloudFile file = read_cloud_file(options.scene);
    const Unit unit = parse_unit(options.unit).value_or(library.settings.unit);
    set_viewpoints(options.viewpoint, unit_factor(unit, library.settings.unit), file.cloud,
                   settings);
    const PointCloud scene = scaled(file.cloud, unit_factor(unit, library.settings.unit));
    const double read_seconds = watch.lap();
    Recognition result = recognizer.recognize(scene, settings);
    result.seconds["load"] = load_seconds;
    result.seconds["read"] = read_seconds;
    const double factor = unit_factor(library.settings.unit, unit);
    say_result(result, settings, unit, factor);
    write_pictures(options, scene, library, result, factor);
    write_json(recognition_json(library, result, options.scene, unit, factor), options.common.json);
}

}  // namespace

void add_recognize(CLI::App& app) {
    auto options = std::make_shared<RecognizeOptions>();
    CLI::App* command = app.add_subcommand("recognize", "find the library's objects in a scan");
    command->add_option("library", options->library, "library made by `ostraka build`")->required();
    command->add_option("scene", options->scene, "scan: PLY, PCD, XYZ or TXT")->required();
    add_unit(*command, options->unit, "unit of the numbers in the scan (default: the library's)");
    command->add_option(
        "--viewpoint", options->viewpoint,
        "position of the sensor as x,y,z, in the scan's frame and unit (default: what the file "
        "says, else the origin); of a scan merged of several: all of them, as \"x,y,z;x,y,z\", or "
        "unknown");
    command
        ->add_option("--min-confidence", options->settings.min_confidence,
                     "objects below it are not reported")
        ->capture_default_str();
    command->add_option("--picture", options->picture,
                        "picture of the scan with each object tinted and labeled to write (PNG)");
    command->add_option("--overlay", options->overlay,
                        "the scan with the placed models in color to write (PLY)");
    command->add_option("--explain", options->explain,
                        "why each object was reported and near misses were not (HTML)");
    command
        ->add_option("--time-limit", options->settings.time_limit,
                     "seconds after which what is best so far is reported; 0: none")
        ->capture_default_str()
        ->check(CLI::NonNegativeNumber);
    command->add_option("--only", options->only,
                        "models to look for, separated by commas (default: all)");
    add_common(*command, options->common);
    command->callback([options] { run_recognize(*options); });
}

}  // namespace ostraka::app
