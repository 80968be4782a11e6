// SPDX-License-Identifier: Apache-2.0
#include "ostraka/evaluation/record_text.hpp"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

using Json = nlohmann::json;

Json pose_numbers(const Pose& pose) {
    Json numbers = Json::array();
    for (int i = 0; i < 12; ++i) numbers.push_back(pose(i / 4, i % 4));
    return numbers;
}

Pose pose_from(const Json& numbers) {
    Pose pose = Pose::Identity();
    for (int i = 0; i < 12; ++i) {
        pose(i / 4, i % 4) = numbers.at(static_cast<std::size_t>(i)).get<double>();
    }
    return pose;
}

// JSON has no infinity, which an error is where a point has no place in the image: null stands for
// it.
double error_from(const Json& number) {
    return number.is_null() ? std::numeric_limits<double>::infinity() : number.get<double>();
}

Json object_json(const TrueObject& object) {
    return {{"model", object.model},
            {"T", pose_numbers(object.T_scene_model)},
            {"visible", object.visible_fraction},
            {"seen", object.pixels_visible},
            {"all", object.pixels_total}};
}

Json report_json(const RecognizedObject& report) {
    return {{"model", report.model_index},     {"T", pose_numbers(report.T_scene_model)},
            {"confidence", report.confidence}, {"visible", report.visible_fraction},
            {"rms", report.inlier_rms},        {"source", report.source}};
}

Json pair_json(const PosePair& pair) {
    return {{"report", pair.report}, {"truth", pair.truth}, {"adi", pair.adi},
            {"mssd", pair.mssd},     {"mspd", pair.mspd},   {"degrees", pair.degrees},
            {"vsd", pair.vsd}};
}

// Parses, and turns every complaint of the JSON library into one of ours.
template <class Read>
auto read_text(const std::string& text, const Read& read) {
    try {
        return read(Json::parse(text));
    } catch (const Json::exception& problem) {
        throw InvalidInput(std::string("a journal's line can't be read: ") + problem.what());
    }
}

std::uint32_t below(std::size_t index, std::size_t count) {
    if (index >= count) throw InvalidInput("a journal's line names what isn't there");
    return static_cast<std::uint32_t>(index);
}

}  // namespace

std::string to_text(const SceneRecord& record) {
    Json json = {{"name", record.name},         {"scene", record.scene},
                 {"image", record.image},       {"clutter", record.clutter},
                 {"width", record.image_width}, {"seconds", record.seconds}};
    json["truth"] = Json::array();
    json["reports"] = Json::array();
    json["pairs"] = Json::array();
    for (const TrueObject& object : record.truth) json["truth"].push_back(object_json(object));
    for (const RecognizedObject& report : record.reports) {
        json["reports"].push_back(report_json(report));
    }
    for (const PosePair& pair : record.pairs) json["pairs"].push_back(pair_json(pair));
    return json.dump();
}

SceneRecord scene_record_from_text(const std::string& text, const ModelLibrary& library) {
    const std::size_t models = library.models.size();
    return read_text(text, [&](const Json& json) {
        SceneRecord record{
            .name = json.at("name"), .scene = json.at("scene"), .image = json.at("image")};
        record.clutter = json.at("clutter").get<std::vector<double>>();
        record.image_width = json.at("width");
        record.seconds = json.at("seconds").get<std::map<std::string, double>>();
        for (const Json& o : json.at("truth")) {
            record.truth.push_back({below(o.at("model"), models), pose_from(o.at("T")),
                                    o.at("visible"), o.at("seen"), o.at("all")});
        }
        for (const Json& r : json.at("reports")) {
            const std::uint32_t model = below(r.at("model"), models);
            record.reports.push_back({.model = library.models[model].name,
                                      .model_index = model,
                                      .T_scene_model = pose_from(r.at("T")),
                                      .confidence = r.at("confidence"),
                                      .visible_fraction = r.at("visible"),
                                      .inlier_rms = r.at("rms"),
                                      .source = r.at("source")});
        }
        for (const Json& p : json.at("pairs")) {
            record.pairs.push_back({below(p.at("report"), record.reports.size()),
                                    below(p.at("truth"), record.truth.size()), p.at("adi"),
                                    p.at("mssd"), error_from(p.at("mspd")), p.at("degrees"),
                                    p.at("vsd").get<std::vector<double>>()});
        }
        if (record.clutter.size() != record.truth.size()) {
            throw InvalidInput("a journal's line is not whole");
        }
        return record;
    });
}

std::string to_text(const std::vector<std::vector<SegmentTrial>>& trials) {
    Json libraries = Json::array();
    for (const std::vector<SegmentTrial>& of_library : trials) {
        Json list = Json::array();
        for (const SegmentTrial& trial : of_library) {
            list.push_back({{"scene", trial.scene},
                            {"model", trial.model},
                            {"visible", trial.visible_fraction},
                            {"answers", trial.answers}});
        }
        libraries.push_back(std::move(list));
    }
    return libraries.dump();
}

std::vector<std::vector<SegmentTrial>> segment_trials_from_text(const std::string& text) {
    return read_text(text, [](const Json& json) {
        std::vector<std::vector<SegmentTrial>> trials;
        for (const Json& list : json) {
            trials.emplace_back();
            for (const Json& t : list) {
                trials.back().push_back(
                    {t.at("scene"), t.at("model"), t.at("visible"),
                     t.at("answers").get<std::map<std::string, std::vector<std::uint32_t>>>()});
            }
        }
        return trials;
    });
}

}  // namespace ostraka
