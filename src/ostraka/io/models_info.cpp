// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/models_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "ostraka/base/error.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/mesh/shape.hpp"
#include "ostraka/mesh/symmetry_poses.hpp"

namespace ostraka {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;  // slow with many keys: for writing only
using Path = std::filesystem::path;

constexpr int kDeepest = 16;  // of nested values; the format needs 4
constexpr std::size_t kMostModels = 1'000'000;
constexpr std::size_t kMostTurns = 10'000;
constexpr std::size_t kMostAxes = 16;
constexpr double kLargest = 1e9;       // mm
constexpr double kOrthonormal = 0.02;  // published matrices are rounded or measured
constexpr std::array<char, 3> kAxisNames = {'x', 'y', 'z'};

// One model of a file, for messages.
struct Place {
    const Path& path;
    std::string model;

    [[noreturn]] void fail(const std::string& problem) const {
        throw FormatError(path, model, problem);
    }
};

Json parse(const Path& path) {
    const FileBytes bytes = read_file(path);
    const auto check_depth = [&](int depth, Json::parse_event_t, Json&) {
        if (depth > kDeepest) {
            throw FormatError(path, "JSON", fmt::format("nested deeper than {}", kDeepest));
        }
        return true;
    };
    try {
        return Json::parse(bytes.span().begin(), bytes.span().end(), check_depth);
    } catch (const Json::parse_error& error) {
        throw FormatError(path, fmt::format("byte {}", error.byte), "is not valid JSON");
    } catch (const Json::out_of_range&) {
        throw FormatError(path, "JSON", "holds a number that is too large");
    }
}

double number(const Json& value, const std::string& what, const Place& place) {
    if (!value.is_number()) place.fail(what + " is not a number");
    const auto result = value.get<double>();
    if (!(std::abs(result) <= kLargest)) place.fail(what + " is out of range");
    return result;
}

double number_of(const Json& model, const std::string& key, const Place& place) {
    const auto found = model.find(key);
    if (found == model.end()) place.fail(fmt::format("has no \"{}\"", key));
    return number(*found, fmt::format("\"{}\"", key), place);
}

Vec3d vector_of(const Json& object, const char* key, const Place& place) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_array() || found->size() != 3) {
        place.fail(fmt::format("a continuous symmetry needs an \"{}\" of 3 numbers", key));
    }
    Vec3d vector;
    for (int k = 0; k < 3; ++k) {
        vector[k] =
            number((*found)[static_cast<std::size_t>(k)], fmt::format("\"{}\"", key), place);
    }
    return vector;
}

// The list under `key`, empty where there is none.
const Json& list_of(const Json& model, const char* key, std::size_t most, const Place& place) {
    static const Json empty = Json::array();
    const auto found = model.find(key);
    if (found == model.end()) return empty;
    if (!found->is_array()) place.fail(fmt::format("\"{}\" is not a list", key));
    if (found->size() > most) {
        place.fail(fmt::format("\"{}\" has {} items, more than {}", key, found->size(), most));
    }
    return *found;
}

Pose turn_from(const Json& numbers, const Place& place) {
    const std::string what = "a discrete symmetry";
    if (!numbers.is_array() || numbers.size() != 16) place.fail(what + " is not 16 numbers");
    Mat4d matrix;
    for (int k = 0; k < 16; ++k) {
        matrix(k / 4, k % 4) = number(numbers[static_cast<std::size_t>(k)], what, place);
    }
    if (matrix.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
        place.fail(what + " has a last row other than 0 0 0 1");
    }
    const Mat3d rotation = matrix.topLeftCorner<3, 3>();
    const Mat3d off = rotation * rotation.transpose() - Mat3d::Identity();
    if (off.cwiseAbs().maxCoeff() > kOrthonormal || rotation.determinant() < 0.0) {
        place.fail(what + " is not a rotation");
    }
    Pose turn = Pose::Identity();
    turn.linear() = Eigen::Quaterniond(Eigen::Matrix3d(rotation)).normalized().toRotationMatrix();
    turn.translation() = matrix.topRightCorner<3, 1>();
    return turn;
}

Symmetry symmetry_from(const Json& model, const Place& place) {
    Symmetry symmetry;
    for (const Json& numbers : list_of(model, "symmetries_discrete", kMostTurns, place)) {
        const Pose turn = turn_from(numbers, place);
        // Some files list the identity, too.
        if (!turn.matrix().isIdentity(1e-6)) symmetry.turns.push_back(turn);
    }
    for (const Json& item : list_of(model, "symmetries_continuous", kMostAxes, place)) {
        if (!item.is_object()) place.fail("a continuous symmetry is not an object");
        const Vec3d direction = vector_of(item, "axis", place);
        if (!(direction.norm() > 1e-6)) place.fail("\"axis\" has no direction");
        symmetry.axes.push_back({direction.normalized(), vector_of(item, "offset", place)});
    }
    symmetry.center = symmetry_center(symmetry.turns, symmetry.axes);
    return symmetry;
}

ModelInfo model_from(const std::string& key, const Json& model, const Path& path) {
    const Place place{path, fmt::format("model \"{}\"", key.substr(0, 40))};
    ModelInfo info;
    const auto [stop, problem] = std::from_chars(key.data(), key.data() + key.size(), info.number);
    if (problem != std::errc() || stop != key.data() + key.size() || info.number < 1) {
        place.fail("is not named by a number from 1");
    }
    if (!model.is_object()) place.fail("is not an object");
    if (const auto name = model.find("name"); name != model.end()) {
        if (!name->is_string()) place.fail("\"name\" is not a text");
        info.name = name->get<std::string>();
    }
    info.diameter = number_of(model, "diameter", place);
    if (!(info.diameter > 0.0)) place.fail("\"diameter\" is not positive");
    for (int k = 0; k < 3; ++k) {
        const char axis = kAxisNames[static_cast<std::size_t>(k)];
        info.low[k] = number_of(model, fmt::format("min_{}", axis), place);
        info.size[k] = number_of(model, fmt::format("size_{}", axis), place);
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
    const Json root = parse(path);
    if (!root.is_object()) throw FormatError(path, "JSON", "is not an object of models");
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
