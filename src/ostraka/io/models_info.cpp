// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/models_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "ostraka/base/error.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/json_reader.hpp"
#include "ostraka/io/rigid_matrix.hpp"
#include "ostraka/io/text.hpp"
#include "ostraka/mesh/shape.hpp"
#include "ostraka/mesh/symmetry_poses.hpp"

namespace ostraka {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;  // slow with many keys: for writing only
using Path = std::filesystem::path;

constexpr std::size_t kMostModels = 1'000'000;
constexpr std::size_t kMostTurns = 10'000;
constexpr std::size_t kMostAxes = 16;
constexpr std::array<char, 3> kAxisNames = {'x', 'y', 'z'};

Vec3d vector_of(const Json& object, const char* key, const JsonPlace& place) {
    const std::vector<double> numbers = json_numbers_of(object, key, 3, place);
    return {numbers[0], numbers[1], numbers[2]};
}

Pose turn_from(const Json& value, const JsonPlace& place) {
    const std::string what = "a discrete symmetry";
    const RigidMatrix matrix = rigid_from(json_numbers(value, 16, what, place));
    if (!matrix.problem.empty()) place.fail(fmt::format("{} {}", what, matrix.problem));
    return matrix.pose;
}

Symmetry symmetry_from(const Json& model, const JsonPlace& place) {
    Symmetry symmetry;
    for (const Json& numbers :
         json_list_or_empty(model, "symmetries_discrete", kMostTurns, place)) {
        const Pose turn = turn_from(numbers, place);
        // Some files list the identity, too.
        if (!turn.matrix().isIdentity(1e-6)) symmetry.turns.push_back(turn);
    }
    for (const Json& item : json_list_or_empty(model, "symmetries_continuous", kMostAxes, place)) {
        const Vec3d direction = vector_of(item, "axis", place);
        if (!(direction.norm() > 1e-6)) place.fail("\"axis\" has no direction");
        symmetry.axes.push_back({direction.normalized(), vector_of(item, "offset", place)});
    }
    symmetry.center = symmetry_center(symmetry.turns, symmetry.axes);
    return symmetry;
}

ModelInfo model_from(const std::string& key, const Json& model, const Path& path) {
    const JsonPlace place{path, fmt::format("model \"{}\"", key.substr(0, 40))};
    ModelInfo info;
    info.number = whole_number(key).value_or(0);
    if (info.number < 1) place.fail("is not named by a number from 1");
    if (!model.is_object()) place.fail("is not an object");
    info.name = json_text_or_empty(model, "name", place);
    info.diameter = json_number_of(model, "diameter", place);
    if (!(info.diameter > 0.0)) place.fail("\"diameter\" is not positive");
    for (int k = 0; k < 3; ++k) {
        const char axis = kAxisNames[static_cast<std::size_t>(k)];
        info.low[k] = json_number_of(model, fmt::format("min_{}", axis), place);
        info.size[k] = json_number_of(model, fmt::format("size_{}", axis), place);
        if (info.size[k] < 0.0) place.fail(fmt::format("\"size_{}\" is negative", axis));
    }
    info.symmetry = symmetry_from(model, place);
    return info;
}

OrderedJson vector_json(const Vec3d& vector) {
    return {vector.x(), vector.y(), vector.z()};
}

OrderedJson model_json(const ModelInfo& info) {
    OrderedJson model = OrderedJson::object();
    model["diameter"] = info.diameter;
    for (int k = 0; k < 3; ++k) {
        model[fmt::format("min_{}", kAxisNames[static_cast<std::size_t>(k)])] = info.low[k];
    }
    for (int k = 0; k < 3; ++k) {
        model[fmt::format("size_{}", kAxisNames[static_cast<std::size_t>(k)])] = info.size[k];
    }
    for (const Pose& turn : info.symmetry.turns) {
        OrderedJson numbers = OrderedJson::array();
        for (int k = 0; k < 16; ++k) numbers.push_back(turn.matrix()(k / 4, k % 4));
        model["symmetries_discrete"].push_back(std::move(numbers));
    }
    for (const ContinuousAxis& axis : info.symmetry.axes) {
        model["symmetries_continuous"].push_back(
            {{"axis", vector_json(axis.direction)}, {"offset", vector_json(axis.point)}});
    }
    if (!info.name.empty()) model["name"] = info.name;
    return model;
}

}  // namespace

ModelInfo model_info(int number, const std::string& name, const TriangleMesh& mesh,
                     const Symmetry& symmetry, Unit unit) {
    const double mm = unit_factor(unit, Unit::millimeter);
    Vec3f low = mesh.vertices[mesh.triangles[0][0]];
    Vec3f high = low;
    for (const Vec3f& vertex : mesh.vertices) {
        low = low.cwiseMin(vertex);
        high = high.cwiseMax(vertex);
    }
    ModelInfo info{.number = number, .name = name, .diameter = mm * measure(mesh).diameter};
    info.low = mm * low.cast<double>();
    info.size = mm * (high.cast<double>() - low.cast<double>());
    info.symmetry = symmetry;
    info.symmetry.center *= mm;
    for (Pose& turn : info.symmetry.turns) turn.translation() *= mm;
    for (ContinuousAxis& axis : info.symmetry.axes) axis.point *= mm;
    return info;
}

std::vector<ModelInfo> read_models_info(const Path& path) {
    const Json root = read_json_object(path);
    if (root.size() > kMostModels) throw FormatError(path, "JSON", "has too many models");
    std::vector<ModelInfo> models;
    for (const auto& [key, model] : root.items()) models.push_back(model_from(key, model, path));
    std::stable_sort(models.begin(), models.end(),
                     [](const ModelInfo& a, const ModelInfo& b) { return a.number < b.number; });
    for (std::size_t i = 1; i < models.size(); ++i) {
        if (models[i].number == models[i - 1].number) {
            throw FormatError(path, fmt::format("model \"{}\"", models[i].number),
                              "is there twice");
        }
    }
    return models;
}

void write_models_info(const Path& path, std::span<const ModelInfo> models) {
    OrderedJson root = OrderedJson::object();
    std::set<int> numbers;
    for (const ModelInfo& info : models) {
        if (info.number < 1 || !numbers.insert(info.number).second) {
            throw InvalidInput(
                fmt::format("models_info: the number {} is used twice or below 1", info.number));
        }
        root[std::to_string(info.number)] = model_json(info);
    }
    // Names come from file names, which needn't be UTF-8.
    write_file_atomically(path,
                          root.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n");
}

}  // namespace ostraka
