// SPDX-License-Identifier: Apache-2.0
// What a library holds, in files that other programs read.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <sstream>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/cloud_file.hpp"
#include "ostraka/io/mesh_file.hpp"
#include "ostraka/io/models_info.hpp"
#include "ostraka/library/library_file.hpp"

namespace ostraka::app {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
    CommonOptions common;
    std::string library;
    std::string folder;
    std::string dump;
    bool entries = false;
};

// BOP's layout: models/obj_000001.ply, ... and models/models_info.json, in millimeters.
void export_models(const ModelLibrary& library, const fs::path& folder) {
    fs::create_directories(folder);
    const auto to_millimeters =
        static_cast<float>(unit_factor(library.settings.unit, Unit::millimeter));
    std::vector<ModelInfo> infos;
    for (const Model& model : library.models) {
        const int number = static_cast<int>(infos.size()) + 1;
        infos.push_back(
            model_info(number, model.name, model.mesh, model.symmetry, library.settings.unit));
        TriangleMesh mesh = model.mesh;
        for (Vec3f& vertex : mesh.vertices) vertex *= to_millimeters;
        write_mesh(folder / fmt::format("obj_{:06}.ply", number), mesh);
    }
    write_models_info(folder / "models_info.json", infos);
}

// entries/MODEL/NUMBER.ply in the model's frame and the library's unit, and a row of each
// descriptor in entries/MODEL/DESCRIPTOR.csv.
void export_entries(const ModelLibrary& library, const fs::path& folder) {
    std::vector<int> numbers(library.models.size(), 0);
    std::vector<std::vector<std::string>> rows(library.models.size(),
                                               std::vector<std::string>(library.tables.size()));
    for (std::size_t e = 0; e < library.entries.size(); ++e) {
        const Entry& entry = library.entries[e];
        const fs::path own = folder / library.models[entry.model].name;
        fs::create_directories(own);
        write_cloud(own / fmt::format("{:04}.ply", numbers[entry.model]++), entry.cloud);
        for (std::size_t t = 0; t < library.tables.size(); ++t) {
            const std::size_t length = descriptor_length(library.tables[t].descriptor);
            const auto row = std::span(library.tables[t].rows).subspan(e * length, length);
            rows[entry.model][t] += fmt::format("{}\n", fmt::join(row, ","));
        }
    }
    for (std::size_t m = 0; m < rows.size(); ++m) {
        for (std::size_t t = 0; t < library.tables.size(); ++t) {
            const std::string_view name = descriptor_name(library.tables[t].descriptor);
            write_file_atomically(folder / library.models[m].name / fmt::format("{}.csv", name),
                                  rows[m][t]);
        }
    }
}

void run_export(const ExportOptions& options) {
    if (options.folder.empty() && options.dump.empty()) {
        throw CLI::ValidationError("export", "give --output, --dump or both");
    }
    if (options.dump == "-") {
        dump_library(options.library, std::cout);
    } else if (!options.dump.empty()) {
        std::ostringstream text;
        dump_library(options.library, text);
        write_file_atomically(options.dump, text.view());
    }
    if (options.folder.empty()) return;
    const ModelLibrary library = load_library(options.library);
    const fs::path folder = options.folder;
    export_models(library, folder / "models");
    if (options.entries) export_entries(library, folder / "entries");
    say(fmt::format("{}: {} models{}", folder.string(), library.models.size(),
                    options.entries ? fmt::format(", {} entries", library.entries.size()) : ""));
    write_json({{"library", options.library},
                {"folder", folder.string()},
                {"models", library.models.size()},
                {"entries", options.entries ? library.entries.size() : 0}},
               options.common.json);
}

}  // namespace

void add_export(CLI::App& app) {
    auto options = std::make_shared<ExportOptions>();
    CLI::App* command = app.add_subcommand(
        "export", "write a library's models, entries or whole content to files for other programs");
    command->add_option("library", options->library, "library made by `ostraka build`")->required();
    command->add_option("-o,--output", options->folder,
                        "folder to write models/ to, in BOP's layout: obj_000001.ply, ... and "
                        "models_info.json with the symmetries, in millimeters");
    command->add_flag("--entries", options->entries,
                      "also entries/MODEL/0000.ply, ... (model frame, library unit) and "
                      "DESCRIPTOR.csv, a line an entry");
    command->add_option("--dump", options->dump,
                        "file to write the whole content to as text, or - for standard output: the "
                        "same for libraries that hold the same");
    add_common(*command, options->common);
    command->callback([options] { run_export(*options); });
}

}  // namespace ostraka::app
