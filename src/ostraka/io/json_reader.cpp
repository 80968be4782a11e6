// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/json_reader.hpp"

#include <fmt/format.h>

#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"

namespace ostraka {
namespace {

using Json = nlohmann::json;
using Path = std::filesystem::path;

constexpr double kLargest = 1e9;  // whatever the unit, lengths and pixels are below it

}  // namespace

void JsonPlace::fail(const std::string& problem) const {
    throw FormatError(path, part, problem);
}

Json parse_json(std::span<const char> bytes, const Path& path, int deepest) {
    const JsonPlace place{path, "JSON"};
    const auto check_depth = [&](int depth, Json::parse_event_t, Json&) {
        if (depth > deepest) place.fail(fmt::format("nested deeper than {}", deepest));
        return true;
    };
    try {
        return Json::parse(bytes.begin(), bytes.end(), check_depth);
    } catch (const Json::parse_error& error) {
        throw FormatError(path, fmt::format("byte {}", error.byte), "is not valid JSON");
    } catch (const Json::out_of_range&) {
        place.fail("holds a number that is too large");
    }
}

Json read_json_object(const Path& path) {
    const FileBytes bytes = read_file(path);
    Json root = parse_json(bytes.span(), path);
    if (!root.is_object()) JsonPlace{path, "JSON"}.fail("is not an object");
    return root;
}

const Json& json_value(const Json& object, const std::string& key, const JsonPlace& place) {
    if (!object.is_object()) place.fail("is not an object");
    const auto found = object.find(key);
    if (found == object.end()) place.fail(fmt::format("has no \"{}\"", key));
    return *found;
}

double json_number(const Json& value, const std::string& what, const JsonPlace& place) {
    if (!value.is_number()) place.fail(what + " is not a number");
    const auto result = value.get<double>();
    if (!(std::abs(result) <= kLargest)) place.fail(what + " is out of range");
    return result;
}

double json_number_of(const Json& object, const std::string& key, const JsonPlace& place) {
    return json_number(json_value(object, key, place), fmt::format("\"{}\"", key), place);
}

int json_integer_of(const Json& object, const std::string& key, const JsonPlace& place) {
    const double value = json_number_of(object, key, place);
    if (value != std::trunc(value)) place.fail(fmt::format("\"{}\" is not a whole number", key));
    return static_cast<int>(value);
}

std::vector<double> json_numbers(const Json& value, std::size_t count, const std::string& what,
                                 const JsonPlace& place) {
    if (!value.is_array() || value.size() != count) {
        place.fail(fmt::format("{} is not a list of {} numbers", what, count));
    }
    std::vector<double> numbers;
    numbers.reserve(count);
    for (const Json& item : value) numbers.push_back(json_number(item, what, place));
    return numbers;
}

std::vector<double> json_numbers_of(const Json& object, const std::string& key, std::size_t count,
                                    const JsonPlace& place) {
    return json_numbers(json_value(object, key, place), count, fmt::format("\"{}\"", key), place);
}

std::string json_text_or_empty(const Json& object, const std::string& key, const JsonPlace& place) {
    const auto found = object.find(key);
    if (found == object.end()) return "";
    if (!found->is_string()) place.fail(fmt::format("\"{}\" is not a text", key));
    return found->get<std::string>();
}

const Json& json_list_or_empty(const Json& object, const std::string& key, std::size_t most,
                               const JsonPlace& place) {
    static const Json empty = Json::array();
    const auto found = object.find(key);
    if (found == object.end()) return empty;
    if (!found->is_array()) place.fail(fmt::format("\"{}\" is not a list", key));
    if (found->size() > most) {
        place.fail(fmt::format("\"{}\" has {} items, more than {}", key, found->size(), most));
    }
    return *found;
}

}  // namespace ostraka
