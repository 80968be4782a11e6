// SPDX-License-Identifier: Apache-2.0
// Internal to io: the JSON of a glTF 2.0 file; a value of the wrong kind is a FormatError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

namespace ostraka {

/// Of JSON values and of nodes; more would endanger assimp's stack.
inline constexpr int kDeepestGltf = 64;

class GltfJson {
  public:
    /// Parses, and checks the version and that no unsupported extension is needed.
    /// @param path  must outlive this. @throws FormatError.
    GltfJson(std::span<const char> text, const std::filesystem::path& path);

    const nlohmann::json& root() const { return root_; }

    /// The whole number in[key], from 0 to 2^40 so that sums can't overflow.
    /// @param where  for the message. @param otherwise  the value where it is missing; none: an
    /// error.
    std::uint64_t number(const nlohmann::json& in, const char* key, const std::string& where,
                         std::optional<std::uint64_t> otherwise = {}) const;

    /// The list in[key]; an empty one where it is missing.
    const nlohmann::json& list(const nlohmann::json& in, const char* key) const;

    /// The object `index` of the top list `key`.
    const nlohmann::json& item(const char* key, std::uint64_t index,
                               const std::string& where) const;

  private:
    void check_asset() const;

    const std::filesystem::path& path_;
    nlohmann::json root_;
};

}  // namespace ostraka
