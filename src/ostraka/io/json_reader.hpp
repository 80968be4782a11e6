// SPDX-License-Identifier: Apache-2.0
// Internal to io: JSON from others; a value of the wrong kind is a FormatError that says where.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

/// Enough for every format but glTF.
inline constexpr int kDeepestJson = 16;

/// A part of a file, for messages.
struct JsonPlace {
    const std::filesystem::path& path;
    std::string part;  ///< "model 12"; short, as it may quote the file

    [[noreturn]] void fail(const std::string& problem) const;
};

/// @param deepest  values may be nested so deep. @throws FormatError.
nlohmann::json parse_json(std::span<const char> bytes, const std::filesystem::path& path,
                          int deepest = kDeepestJson);

/// parse_json() of the file, which must hold an object. @throws FileError, FormatError.
nlohmann::json read_json_object(const std::filesystem::path& path);

/// The value under `key`; an error where there is none or `object` isn't one.
const nlohmann::json& json_value(const nlohmann::json& object, const std::string& key,
                                 const JsonPlace& place);

/// A number of at most 1e9 in size. @param what  for the message.
double json_number(const nlohmann::json& value, const std::string& what, const JsonPlace& place);
double json_number_of(const nlohmann::json& object, const std::string& key, const JsonPlace& place);

/// A number without fraction, however it is written (12 or 12.0).
int json_integer_of(const nlohmann::json& object, const std::string& key, const JsonPlace& place);

/// Exactly `count` numbers.
std::vector<double> json_numbers(const nlohmann::json& value, std::size_t count,
                                 const std::string& what, const JsonPlace& place);
std::vector<double> json_numbers_of(const nlohmann::json& object, const std::string& key,
                                    std::size_t count, const JsonPlace& place);

/// A text; empty where there is none.
std::string json_text_or_empty(const nlohmann::json& object, const std::string& key,
                               const JsonPlace& place);

/// The list under `key`, empty where there is none. @param most  items it may have.
const nlohmann::json& json_list_or_empty(const nlohmann::json& object, const std::string& key,
                                         std::size_t most, const JsonPlace& place);

}  // namespace ostraka
