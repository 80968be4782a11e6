// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/gltf_json.hpp"

#include <fmt/format.h>

#include "ostraka/base/error.hpp"
#include "ostraka/io/json_reader.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

using Json = nlohmann::json;
using Path = std::filesystem::path;

constexpr std::uint64_t kLargest = std::uint64_t{1} << 40;

[[noreturn]] void fail(const Path& path, const std::string& where, const std::string& problem) {
    throw FormatError(path, where, problem);
}

}  // namespace

GltfJson::GltfJson(std::span<const char> text, const std::filesystem::path& path)
    : path_(path), root_(parse_json(text, path, kDeepestGltf)) {
    check_asset();
}

std::uint64_t GltfJson::number(const Json& in, const char* key, const std::string& where,
                               std::optional<std::uint64_t> otherwise) const {
    const auto found = in.find(key);
    if (found == in.end() && otherwise) {
        return *otherwise;
    }
    if (found == in.end() || !found->is_number_unsigned() ||
        found->get<std::uint64_t>() > kLargest) {
        fail(path_, where, fmt::format("\"{}\" is not a usable whole number", key));
    }
    return found->get<std::uint64_t>();
}

const Json& GltfJson::list(const Json& in, const char* key) const {
    static const Json empty = Json::array();
    const auto found = in.find(key);
    if (found != in.end() && !found->is_array()) {
        fail(path_, "JSON", fmt::format("\"{}\" is not a list", key));
    }
    return found == in.end() ? empty : *found;
}

const Json& GltfJson::item(const char* key, std::uint64_t index, const std::string& where) const {
    const Json& items = list(root_, key);
    if (index >= items.size() || !items[index].is_object()) {
        fail(path_, where, fmt::format("names {} {} of {}", key, index, items.size()));
    }
    return items[index];
}

void GltfJson::check_asset() const {
    const auto asset = root_.is_object() ? root_.find("asset") : root_.end();
    if (!root_.is_object() || asset == root_.end() || !asset->is_object()) {
        fail(path_, "JSON", "not a glTF file: no \"asset\"");
    }
    const auto version = asset->find("version");
    if (version == asset->end() || !version->is_string() ||
        !version->get_ref<const std::string&>().starts_with("2.")) {
        fail(path_, "JSON", "only glTF version 2 is supported");
    }
    for (const Json& name : list(root_, "extensionsRequired")) {
        const std::string text = name.is_string() ? name.get<std::string>() : "";
        if (text.find("compression") != std::string::npos || text == "KHR_mesh_quantization") {
            fail(path_, "JSON", "needs the unsupported extension " + quote_word(text));
        }
    }
}

}  // namespace ostraka
