// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/io/png_file.hpp"
#include "ostraka/library/library_file.hpp"
#include "ostraka/library/settings_text.hpp"
#include "ostraka/mesh/symmetry_poses.hpp"
#include "ostraka/recognition/contact_sheet.hpp"

namespace ostraka::app {
namespace {

struct InspectOptions {
    CommonOptions common;
    std::string library;
    std::string picture;
};

Json inspect_json(const ModelLibrary& library, const std::string& path) {
    Json models = Json::array();
    for (const Model& model : library.models) {
        models.push_back({{"model", model.name},
                          {"file", model.file},
                          {"sha256", model.sha256},
                          {"diameter", model.shape.diameter},
                          {"triangles", model.mesh.triangles.size()},
                          {"entries", model.counts.kept},
                          {"keypoints", model.keypoints.size()},
                          {"symmetry", symmetry_name(model.symmetry)},
                          {"coverage", model.counts.coverage},
                          {"covered", coverage_json(model.counts)}});
    }
    Json settings = Json::object();
    for (const auto& [key, value] : to_text(library.settings)) settings[key] = value;
    return {{"library", path},
            {"format", kLibraryFormat},
            {"unit", unit_name(library.settings.unit)},
            {"sampling", library.settings.sampling},
            {"entries", library.entries.size()},
            {"settings", settings},
            {"models", models}};
}

void run_inspect(const InspectOptions& options) {
    const ModelLibrary library = load_library(options.library);
    std::vector<std::vector<std::string>> rows = {{"model", "diameter", "triangles", "symmetry",
                                                   "entries", "whole views", "coverage",
                                                   "keypoints", "file"}};
    for (std::uint32_t m = 0; m < library.models.size(); ++m) {
        const Model& model = library.models[m];
        const auto whole = std::count_if(
            library.entries.begin(), library.entries.end(),
            [&](const Entry& entry) { return entry.model == m && entry.direction < 0; });
        rows.push_back(
            {model.name,
             fmt::format("{:.4g} {}", model.shape.diameter, unit_name(library.settings.unit)),
             std::to_string(model.mesh.triangles.size()), symmetry_name(model.symmetry),
             std::to_string(model.counts.kept), std::to_string(whole),
             fmt::format("{:.3f}", model.counts.coverage), std::to_string(model.keypoints.size()),
             model.file});
    }
    say_table(rows);
    std::string names;
    for (const DescriptorTable& table : library.tables) {
        names += fmt::format(" {}", descriptor_name(table.descriptor));
    }
    say(fmt::format("{} entries, sampling {:.4g} {}, {} views a model, descriptors:{}",
                    library.entries.size(), library.settings.sampling,
                    unit_name(library.settings.unit), library.settings.views.count, names));
    if (!options.picture.empty()) {
        write_png(options.picture, draw_contact_sheet(library));
        say("contact sheet: " + options.picture);
    }
    write_json(inspect_json(library, options.library), options.common.json);
}

}  // namespace

void add_inspect(CLI::App& app) {
    auto options = std::make_shared<InspectOptions>();
    CLI::App* command = app.add_subcommand("inspect", "show what a library holds");
    command->add_option("library", options->library, "library made by `ostraka build`")->required();
    command->add_option("--picture", options->picture,
                        "contact sheet of the entries to write (PNG)");
    add_common(*command, options->common);
    command->callback([options] { run_inspect(*options); });
}

}  // namespace ostraka::app
