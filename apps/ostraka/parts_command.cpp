// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/io/mesh_file.hpp"
#include "ostraka/simulation/parts.hpp"

namespace ostraka::app {
namespace {

struct PartsOptions {
    CommonOptions common;
    std::string output;
    std::vector<std::string> names;
    std::string format = "ply";
    int variants = 1;
    PartSettings settings;
};

std::vector<PartKind> chosen_parts(const std::vector<std::string>& names) {
    if (names.empty()) return all_parts();
    std::vector<PartKind> kinds;
    for (const std::string& name : names) {
        const auto kind = parse_part(name);
        if (!kind) throw CLI::ValidationError("parts", "there is no part " + name);
        kinds.push_back(*kind);
    }
    return kinds;
}

void run_parts(const PartsOptions& options) {
    catch_interrupts();
    const std::vector<PartKind> kinds = chosen_parts(options.names);
    std::error_code problem;
    std::filesystem::create_directories(options.output, problem);
    if (problem) throw FileError(options.output, problem.message());
    const Progress progress = progress_bar();
    const auto variants = static_cast<std::size_t>(options.variants);
    Json files = Json::array();
    for (std::size_t i = 0; i < kinds.size() * variants; ++i) {
        PartSettings settings = options.settings;
        settings.seed += i / kinds.size();
        const PartKind kind = kinds[i % kinds.size()];
        const std::string suffix = settings.seed == 0 ? "" : fmt::format("_{}", settings.seed);
        const std::string file = fmt::format("{}{}.{}", part_name(kind), suffix, options.format);
        write_mesh(std::filesystem::path(options.output) / file, make_part(kind, settings));
        files.push_back(file);
        report(progress, "parts", i + 1, kinds.size() * variants);
    }
    say(fmt::format("{} parts, in mm, in {}", files.size(), options.output));
    write_json({{"unit", "mm"}, {"folder", options.output}, {"parts", files}}, options.common.json);
}

}  // namespace

void add_parts(CLI::App& app) {
    auto options = std::make_shared<PartsOptions>();
    CLI::App* command =
        app.add_subcommand("parts", "make meshes of parametric machine parts to try things on");
    std::string known;
    for (const PartKind kind : all_parts()) known += fmt::format(" {}", part_name(kind));
    command->add_option("parts", options->names, "which (default: all):" + known);
    command->add_option("-o,--output", options->output, "folder to write to")->required();
    command->add_option("--seed", options->settings.seed,
                        "0: the nominal part; others vary its proportions");
    command->add_option("--variants", options->variants, "make so many of each, seed upward")
        ->check(CLI::Range(1, 1000000));
    command->add_option("--format", options->format, "ply, stl, obj or off")
        ->capture_default_str()
        ->check(CLI::IsMember({"ply", "stl", "obj", "off"}));
    add_common(*command, options->common);
    command->callback([options] { run_parts(*options); });
}

}  // namespace ostraka::app
