// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/io/cloud_file.hpp"
#include "ostraka/library/library_file.hpp"
#include "ostraka/library/retrieval.hpp"

namespace ostraka::app {
namespace {

struct ClassifyOptions {
    CommonOptions common;
    std::string library;
    std::vector<std::string> segments;
    std::string unit;
    std::string viewpoint;
    std::string descriptor = "fused";
    std::size_t k = 1;
};

PreparedSegment load_segment(const std::string& path, const ClassifyOptions& options,
                             const LibrarySettings& settings) {
    PointCloud cloud = read_cloud_file(path).cloud;
    if (const auto viewpoint = parse_viewpoint(options.viewpoint)) cloud.viewpoint = *viewpoint;
    const Unit unit = parse_unit(options.unit).value_or(settings.unit);
    cloud = scaled(std::move(cloud), unit_factor(unit, settings.unit));
    PreparedSegment segment = prepare_segment(cloud, settings);
    if (segment.piece.size() < 10) {
        throw InvalidInput(
            fmt::format("{}: {} points at the library's sampling distance {:.4g} {}: "
                        "at least 10 are needed (is the unit right?)",
                        path, segment.piece.size(), settings.sampling, unit_name(settings.unit)));
    }
    return segment;
}

Json ranking_json(const std::vector<RankedModel>& ranking, const ModelLibrary& library) {
    Json list = Json::array();
    for (const RankedModel& ranked : ranking) {
        const Entry& entry = library.entries[ranked.best.entry];
        Json subpart = nullptr;  // a whole view
        if (entry.direction >= 0) {
            const auto fraction = static_cast<std::size_t>(entry.fraction);
            subpart = {{"direction", entry.direction},
                       {"fraction", library.settings.cuts.fractions.at(fraction)}};
        }
        list.push_back({{"model", library.models[ranked.model].name},
                        {"score", ranked.score},
                        {"view", entry.view},
                        {"subpart", subpart},
                        {"votes", ranked.votes},
                        {"distance", ranked.best.distance},
                        {"entry", ranked.best.entry}});
    }
    return list;
}

void run_classify(const ClassifyOptions& options) {
    const ModelLibrary library = load_library(options.library);
    const EntryIndex index(library);
    Json segments = Json::array();
    std::vector<std::vector<std::string>> rows = {
        {"segment", "model", "score", "votes", "distance", "second"}};
    for (const std::string& path : options.segments) {
        const PreparedSegment segment = load_segment(path, options, library.settings);
        const auto ranking = classify(index, segment, options.descriptor, options.k);
        segments.push_back({{"file", path}, {"ranking", ranking_json(ranking, library)}});
        const RankedModel& best = ranking.front();
        rows.push_back({path, library.models[best.model].name, fmt::format("{:.2f}", best.score),
                        std::to_string(best.votes), fmt::format("{:.3f}", best.best.distance),
                        ranking.size() > 1 ? library.models[ranking[1].model].name : "-"});
    }
    say_table(rows);
    write_json({{"segments", segments}}, options.common.json);
}

}  // namespace

void add_classify(CLI::App& app) {
    auto options = std::make_shared<ClassifyOptions>();
    CLI::App* command =
        app.add_subcommand("classify", "say which model each pre-cut segment of a scan shows");
    command->add_option("library", options->library, "library made by `ostraka build`")->required();
    command->add_option("segments", options->segments, "segments: PLY, PCD, XYZ or TXT")
        ->required();
    add_unit(*command, options->unit,
             "unit of the numbers in the segments (default: the library's)");
    add_viewpoint(*command, options->viewpoint);
    command
        ->add_option("--descriptor", options->descriptor,
                     "vfh, esf, gasd, shot, rops, bag_of_words (whole piece); keypoints (local "
                     "SHOT that agree on "
                     "a pose); fused: all together")
        ->capture_default_str();
    command->add_option("--k", options->k, "nearest entries that vote")
        ->capture_default_str()
        ->check(CLI::Range(1, 100000));
    add_common(*command, options->common);
    command->callback([options] { run_classify(*options); });
}

}  // namespace ostraka::app
