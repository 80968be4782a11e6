// SPDX-License-Identifier: Apache-2.0
// Recognition of whole scenes (protocol O): ours and peers that are told what is there, on the same
// scenes, judged by the same code.
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/library/build.hpp"
#include "ostraka/library/library_file.hpp"
#include "scene_cases.hpp"
#include "scene_peers.hpp"

namespace ostraka::bench {
namespace {

constexpr double kLeastConfidence = 0.05;  // of our reports; the first row has its own threshold

struct Row {
    std::string name;
    std::string settings;
    bool told = false;
    double training = -1.0;  // seconds; below 0: not measured
    double wall = 0.0;       // seconds of all scenes
    double processor = 0.0;  // seconds of all scenes
    std::vector<SceneRecord> records;
};

// Wall and processor time since the last lap.
struct Clocks {
    Stopwatch wall;
    std::clock_t before = std::clock();
    void lap(Row& row) {
        row.wall += wall.lap();
        const std::clock_t now = std::clock();
        row.processor += static_cast<double>(now - before) / CLOCKS_PER_SEC;
        before = now;
    }
};

double build_seconds(const ModelLibrary& library) {
    std::vector<ModelSource> sources;
    for (const Model& model : library.models) sources.push_back({model.name, model.mesh});
    const Stopwatch watch;
    build_library(sources, library.settings);
    return watch.seconds();
}

// @param seconds  that it took to build, if it was built.
ModelLibrary library_of(const SceneCases& cases, double& seconds) {
    const std::filesystem::path first = cases.inputs.front();
    if (cases.inputs.size() == 1 && first.extension() == ".ostraka") {
        ModelLibrary library = load_library(first);
        if (cases.time_build) seconds = build_seconds(library);
        return library;
    }
    std::vector<ModelSource> sources;
    for (const std::string& input : cases.inputs) sources.push_back(load_model(input));
    LibrarySettings settings;
    settings.unit = *parse_unit(cases.unit);
    const Stopwatch watch;
    ModelLibrary library = build_library(sources, settings);
    seconds = watch.seconds();
    return library;
}

// As many of the most confident reports of each model as there are objects of it.
std::vector<RecognizedObject> most_confident(const SceneRecord& record, std::vector<int> counts) {
    std::vector<RecognizedObject> kept;
    for (const RecognizedObject& report : record.reports) {
        if (counts[report.model_index]-- > 0) kept.push_back(report);
    }
    // Every report that is asked for counts, however little it was trusted.
    for (RecognizedObject& report : kept) report.confidence = 1.0;
    return kept;
}

std::vector<ScenePeer> chosen_peers(const SceneCases& cases, const ModelLibrary& library) {
    const PeerSettings settings{.threads = static_cast<int>(thread_count()),
                                .opencv_step = cases.opencv_step,
                                .seed = cases.seed};
    std::vector<ScenePeer> chosen;
    for (const auto& [name, make] :
         {std::pair{"open3d", &open3d_scene_peers}, std::pair{"opencv", &opencv_scene_peers}}) {
        if (cases.peers.find(name) == std::string::npos) continue;
        const std::vector<ScenePeer> peers = make(library, settings);
        if (peers.empty()) fmt::print(stderr, "{}: skipped, it was not found\n", name);
        chosen.insert(chosen.end(), peers.begin(), peers.end());
    }
    return chosen;
}

void say_scene(const Row& row, const ModelLibrary& library) {
    const SceneSummary summary = summarize(std::span(row.records).last(1), library);
    fmt::print(stderr, "{:<10} {:<18} {} of {} right\n", row.records.back().name, row.name,
               summary.hits, summary.objects);
}

// Rows: ours, ours told, and each peer.
std::vector<Row> run_scenes(const TestSet& set, const ModelLibrary& library,
                            const std::vector<ScenePeer>& peers, double built) {
    std::vector<Row> rows = {{.name = "Ostraka", .training = built},
                             {.name = "Ostraka, told", .told = true, .training = built}};
    rows[0].settings = "its own";
    rows[1].settings = "the same reports, the most confident ones of each model";
    for (const ScenePeer& peer : peers) {
        const Stopwatch watch;
        peer.train();
        rows.push_back({.name = peer.name,
                        .settings = peer.settings,
                        .told = true,
                        .training = watch.seconds()});
        fmt::print(stderr, "{}: trained in {:.1f} s\n", peer.name, rows.back().training);
    }
    const Recognizer recognizer(library);
    const PoseJudge judge(library, false);
    SceneSettings settings;
    settings.recognition.min_confidence = kLeastConfidence;
    for (std::size_t s = 0; s < set.count; ++s) {
        const TestScene scene = set.load(s);
        const std::vector<int> counts = told_counts(scene, library.models.size());
        Clocks clocks;
        Recognition answer = recognizer.recognize(scene.cloud, settings.recognition);
        clocks.lap(rows[0]);
        rows[0].records.push_back(record_of(judge, scene, std::move(answer.objects), settings));
        rows[1].records.push_back(
            record_of(judge, scene, most_confident(rows[0].records.back(), counts), settings));
        const PointCloud scan = peer_scan(scene.cloud, library);
        say_scene(rows[0], library);
        for (std::size_t p = 0; p < peers.size(); ++p) {
            Row& row = rows[p + 2];
            clocks = {};
            std::vector<RecognizedObject> found = find_told(peers[p], library, scan, counts);
            clocks.lap(row);
            row.records.push_back(record_of(judge, scene, std::move(found), settings));
            say_scene(row, library);
        }
    }
    rows[1].wall = rows[0].wall;
    rows[1].processor = rows[0].processor;
    return rows;
}

void print_table(const std::vector<Row>& rows, const ModelLibrary& library) {
    fmt::print("{:<18} {:>5} {:>7} {:>6} {:>6} {:>6} {:>6} {:>7} {:>7} {:>7} {:>8} {:>7}\n", "",
               "told", "objects", "recall", "at 5%", "at 2%", "prec.", "ADI", "s/scene", "cpu s",
               "train s", "threads");
    for (const Row& row : rows) {
        const auto recall = [&](double max_adi) {
            return summarize(row.records, library, {.max_adi = max_adi}).recall.value;
        };
        const SceneSummary summary = summarize(row.records, library);
        const auto scenes = static_cast<double>(row.records.size());
        fmt::print(
            "{:<18} {:>5} {:>7} {:>6.3f} {:>6.3f} {:>6.3f} {:>6.3f} {:>6.2f}% {:>7.2f} "
            "{:>7.2f} {:>8} {:>7}\n",
            row.name, row.told ? "yes" : "no", summary.objects, summary.recall.value, recall(0.05),
            recall(0.02), summary.precision.value, summary.median_adi.value * 100.0,
            row.wall / scenes, row.processor / scenes,
            row.training < 0.0 ? "-" : fmt::format("{:.1f}", row.training), thread_count());
    }
    for (const Row& row : rows) fmt::print("{}: {}\n", row.name, row.settings);
    fmt::print("told: which models are there and how often; its precision is right / returned\n");
}

nlohmann::ordered_json interval_json(const Interval& interval) {
    return {{"value", interval.value}, {"low", interval.low}, {"high", interval.high}};
}

nlohmann::ordered_json row_json(const Row& row, const ModelLibrary& library) {
    nlohmann::ordered_json json = {{"name", row.name}, {"told", row.told}};
    for (const auto& [key, max_adi] :
         {std::pair{"recall", 0.10}, std::pair{"recall_5", 0.05}, std::pair{"recall_2", 0.02}}) {
        json[key] = interval_json(summarize(row.records, library, {.max_adi = max_adi}).recall);
    }
    const SceneSummary summary = summarize(row.records, library);
    const auto scenes = static_cast<double>(row.records.size());
    json["objects"] = summary.objects;
    json["hits"] = summary.hits;
    json["wrong"] = summary.wrong;
    json["precision"] = interval_json(summary.precision);
    json["median_adi"] = interval_json(summary.median_adi);
    json["seconds"] = row.wall / scenes;
    json["processor_seconds"] = row.processor / scenes;
    json["training_seconds"] =
        row.training < 0.0 ? nlohmann::ordered_json() : nlohmann::ordered_json(row.training);
    json["threads"] = thread_count();
    json["settings"] = row.settings;
    return json;
}

void write_json(const std::filesystem::path& path, const SceneCases& cases,
                const std::vector<Row>& rows, const ModelLibrary& library) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Row& row : rows) list.push_back(row_json(row, library));
    const nlohmann::ordered_json json = {{"on", scene_text(cases)},
                                         {"models", library.models.size()},
                                         {"scenes", rows.front().records.size()},
                                         {"rows", list}};
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
    std::ofstream file(path);
    file << json.dump(1) << '\n';
    if (!file.flush()) throw FileError(path, "can't be written");
}

int run_all(const SceneCases& cases) {
    set_thread_count(cases.threads);
    double built = -1.0;
    const ModelLibrary library = library_of(cases, built);
    const TestSet set = test_set_of(cases, library);
    for (const std::string& note : set.notes) fmt::print(stderr, "{}\n", note);
    fmt::print("{}; {} models\n", scene_text(cases), library.models.size());
    std::fflush(stdout);
    const std::vector<Row> rows = run_scenes(set, library, chosen_peers(cases, library), built);
    print_table(rows, library);
    if (!cases.json.empty()) write_json(cases.json, cases, rows, library);
    return 0;
}

}  // namespace
}  // namespace ostraka::bench

int main(int count, char** arguments) {
    try {
        const auto cases = ostraka::bench::parse_scene_cases(count, arguments);
        if (cases.help) {
            fmt::print("{}", ostraka::bench::scene_cases_help());
            return 0;
        }
        return ostraka::bench::run_all(cases);
    } catch (const std::exception& error) {
        fmt::print(stderr, "bench_scenes: {}\n", error.what());
        return 1;
    }
}
