// SPDX-License-Identifier: Apache-2.0
// Khronos Group. glTF 2.0 Specification. 2021. Section numbers refer to it.
#include "ostraka/io/gltf_sanitize.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/gltf_container.hpp"
#include "ostraka/io/gltf_json.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

using Json = nlohmann::json;
using Path = std::filesystem::path;

constexpr std::uint64_t kMostCorners = 10'000'000;  // of all instances, beside:
constexpr std::uint64_t kMostInstances = 16;        // for each stored byte
constexpr std::uint64_t kMostCopies = 4;    // of a buffer's byte; valid accessors hardly overlap
constexpr std::uint64_t kMostStride = 252;  // 5.11.4

constexpr int kTriangles = 4;  // 3.7.2.1: the modes that make triangles are 4, 5 and 6
constexpr int kTriangleFan = 6;
constexpr std::uint64_t kFloat = 5126;
constexpr std::uint64_t kUint8 = 5121;
constexpr std::uint64_t kUint16 = 5123;
constexpr std::uint64_t kUint32 = 5125;

[[noreturn]] void fail(const Path& path, const std::string& where, const std::string& problem) {
    throw FormatError(path, where, problem);
}

// Bytes of an index of componentType `type`; 0 if it is none.
std::uint64_t index_size(std::uint64_t type) {
    return type == kUint8 ? 1 : type == kUint16 ? 2 : type == kUint32 ? 4 : 0;
}

std::uint32_t load_index(const char* bytes, std::uint64_t size) {
    return size == 1   ? load<std::uint8_t>(bytes)
           : size == 2 ? load<std::uint16_t>(bytes)
                       : load<std::uint32_t>(bytes);
}

class Sanitizer {
  public:
    Sanitizer(const GltfChunks& chunks, const Path& path)
        : path_(path), bin_(chunks.bin), in_(chunks.json, path) {}

    std::string sanitize() {
        read_buffers();
        const Json roots = find_roots();
        add_nodes(roots);
        if (out_["meshes"].empty()) {
            return {};
        }
        out_["asset"] = {{"version", "2.0"}};
        out_["scenes"] = Json::array({{{"nodes", roots}}});
        out_["scene"] = 0;
        out_["buffers"] = Json::array({{{"byteLength", data_.size()}}});
        return pack();
    }

  private:
    void read_buffers() {
        const Json& buffers = in_.list(in_.root(), "buffers");
        for (std::size_t i = 0; i < buffers.size(); ++i) {
            const std::string where = fmt::format("buffer {}", i);
            const Json& buffer = in_.item("buffers", i, where);
            const std::uint64_t size = in_.number(buffer, "byteLength", where);
            const auto uri = buffer.find("uri");
            if (uri == buffer.end()) {
                append(bin_, size, where);
            } else if (uri->is_string()) {
                append_uri(uri->get_ref<const std::string&>(), size, where);
            } else {
                fail(path_, where, "\"uri\" is not a text");
            }
        }
    }

    void append(std::span<const char> bytes, std::uint64_t size, const std::string& where) {
        if (size > bytes.size()) {
            fail(path_, where, fmt::format("states {} bytes, there are {}", size, bytes.size()));
        }
        buffers_.emplace_back(bytes.data(), size);
        buffers_size_ += size;
    }

    void append_uri(std::string_view uri, std::uint64_t size, const std::string& where) {
        if (!uri.starts_with("data:")) {
            append(read_file(path_.parent_path() / decode_percent(uri)).span(), size, where);
            return;
        }
        constexpr std::string_view kBase64 = ";base64,";
        const std::size_t start = uri.substr(0, 100).find(kBase64);
        std::optional<std::string> bytes;
        if (start != std::string_view::npos) {
            bytes = decode_base64(uri.substr(start + kBase64.size()));
        }
        if (!bytes) {
            fail(path_, where, "is not valid base64");
        }
        append(*bytes, size, where);
    }

    // Where the elements of an accessor lie; all of them inside their buffer.
    struct Elements {
        std::uint64_t type = 0;  // componentType
        std::uint64_t count = 0;
        std::uint64_t size = 0;    // bytes of one
        std::uint64_t stride = 0;  // bytes from one to the next
        const char* first = nullptr;
    };

    Elements find_elements(std::uint64_t index, bool positions) const {
        const std::string where = fmt::format("accessor {}", index);
        const Json& in = in_.item("accessors", index, where);
        Elements elements;
        elements.type = in_.number(in, "componentType", where);
        elements.count = in_.number(in, "count", where);
        const std::string shape = in.value("type", "");
        const bool fits = positions ? elements.type == kFloat && shape == "VEC3"
                                    : index_size(elements.type) > 0 && shape == "SCALAR";
        if (!fits) {
            fail(path_, where,
                 positions ? "positions must be three floats"
                           : "indices must be unsigned whole numbers");
        }
        if (elements.count == 0 || in.contains("sparse")) {
            fail(path_, where, "empty and sparse accessors are not supported");
        }
        const Json& view = in_.item("bufferViews", in_.number(in, "bufferView", where), where);
        const std::uint64_t buffer = in_.number(view, "buffer", where);
        in_.item("buffers", buffer, where);
        const std::uint64_t start = in_.number(view, "byteOffset", where, 0);
        const std::uint64_t view_size = in_.number(view, "byteLength", where);
        const std::uint64_t skipped = in_.number(in, "byteOffset", where, 0);
        elements.size = positions ? sizeof(Vec3f) : index_size(elements.type);
        elements.stride = in_.number(view, "byteStride", where, elements.size);
        const std::uint64_t end = skipped + elements.size + elements.stride * (elements.count - 1);
        if (elements.stride < elements.size || elements.stride > kMostStride || end > view_size ||
            start + view_size > buffers_[buffer].size()) {
            fail(path_, where, fmt::format("{} elements don't fit their buffer", elements.count));
        }
        elements.first = buffers_[buffer].data() + start + skipped;
        return elements;
    }

    // Copies accessor `index` without the gaps between its elements, once. @return its new index.
    std::uint64_t add_accessor(std::uint64_t index, bool positions) {
        const auto known = new_accessors_.find(index);
        const Elements elements = find_elements(index, positions);
        if (known != new_accessors_.end()) {
            return known->second;
        }
        const std::size_t size = elements.count * elements.size;
        if (data_.size() + size > kMostCopies * buffers_size_) {
            fail(path_, fmt::format("accessor {}", index), "too many accessors overlap");
        }
        out_["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", data_.size()}, {"byteLength", size}});
        for (std::uint64_t i = 0; i < elements.count; ++i) {
            data_.append(elements.first + elements.stride * i, elements.size);
        }
        data_.resize((data_.size() + 3) / 4 * 4);
        const std::uint64_t new_index = out_["accessors"].size();
        out_["accessors"].push_back({{"bufferView", new_index},
                                     {"componentType", elements.type},
                                     {"count", elements.count},
                                     {"type", positions ? "VEC3" : "SCALAR"}});
        return new_accessors_[index] = new_index;
    }

    // @return the number of indices, each of which names one of `vertices`.
    std::uint64_t check_index_values(std::uint64_t index, std::uint64_t vertices) const {
        const Elements elements = find_elements(index, false);
        for (std::uint64_t i = 0; i < elements.count; ++i) {
            const std::uint32_t vertex =
                load_index(elements.first + elements.stride * i, elements.size);
            if (vertex >= vertices) {
                fail(path_, fmt::format("accessor {}", index),
                     fmt::format("names vertex {}, but there are {}", vertex, vertices));
            }
        }
        return elements.count;
    }

    // Adds mesh `index` without the primitives that make no triangles. @return its corners.
    std::uint64_t add_mesh(std::uint64_t index) {
        const std::string where = fmt::format("mesh {}", index);
        std::uint64_t corners = 0;
        Json primitives = Json::array();
        for (const Json& in : in_.list(in_.item("meshes", index, where), "primitives")) {
            const auto attributes = in.is_object() ? in.find("attributes") : in.end();
            if (!in.is_object() || attributes == in.end() || !attributes->is_object()) {
                fail(path_, where, "primitive without attributes");
            }
            const std::uint64_t mode = in_.number(in, "mode", where, kTriangles);
            if (mode < kTriangles || mode > kTriangleFan || !attributes->contains("POSITION")) {
                continue;
            }
            Json out = {{"mode", mode}};
            const std::uint64_t positions = in_.number(*attributes, "POSITION", where);
            const std::uint64_t vertices = find_elements(positions, true).count;
            corners += vertices;
            out["attributes"]["POSITION"] = add_accessor(positions, true);
            if (in.contains("indices")) {
                const std::uint64_t indices = in_.number(in, "indices", where);
                corners += check_index_values(indices, vertices);
                out["indices"] = add_accessor(indices, false);
            }
            primitives.push_back(std::move(out));
        }
        if (!primitives.empty()) {
            new_meshes_[index] = out_["meshes"].size();
            out_["meshes"].push_back({{"primitives", std::move(primitives)}});
        }
        return corners;
    }

    // The scene's nodes, or those that are nobody's child if there is no scene. Also checks that no
    // node is the child of two, so that the nodes below a root form a tree.
    Json find_roots() {
        const Json& nodes = in_.list(in_.root(), "nodes");
        std::vector<bool> is_child(nodes.size(), false);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const std::string where = fmt::format("node {}", i);
            for (const Json& child : in_.list(in_.item("nodes", i, where), "children")) {
                const std::uint64_t index =
                    child.is_number_unsigned() ? child.get<std::uint64_t>() : nodes.size();
                if (index >= nodes.size() || is_child[index]) {
                    fail(path_, where, "has a child that doesn't exist or has another parent");
                }
                is_child[index] = true;
            }
        }
        Json roots = Json::array();
        if (in_.list(in_.root(), "scenes").empty()) {
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                if (!is_child[i]) {
                    roots.push_back(i);
                }
            }
            return roots;
        }
        std::vector<bool> is_root(nodes.size(), false);
        const Json& scene = in_.item("scenes", in_.number(in_.root(), "scene", "JSON", 0), "scene");
        for (const Json& root : in_.list(scene, "nodes")) {
            const std::uint64_t index =
                root.is_number_unsigned() ? root.get<std::uint64_t>() : nodes.size();
            if (index >= nodes.size() || is_child[index] || is_root[index]) {
                fail(path_, "scene", "a node doesn't exist, is another's child or is named twice");
            }
            is_root[index] = true;
            roots.push_back(index);
        }
        return roots;
    }

    // Numbers of a node's transform, `size` of them.
    void copy_numbers(const Json& in, const char* key, std::size_t size, Json& out) const {
        const auto found = in.find(key);
        if (found == in.end()) {
            return;
        }
        const bool valid =
            found->is_array() && found->size() == size &&
            std::all_of(found->begin(), found->end(), [](const Json& n) { return n.is_number(); });
        if (!valid) {
            fail(path_, "JSON", fmt::format("a node's \"{}\" must be {} numbers", key, size));
        }
        out[key] = *found;
    }

    // Copies the nodes (all keep their index) and the meshes that nodes below the roots hold.
    void add_nodes(const Json& roots) {
        const Json& nodes = in_.list(in_.root(), "nodes");
        out_["nodes"] = Json(nodes.size(), Json::object());
        std::vector<std::pair<std::uint64_t, int>> open;  // node, depth
        for (const Json& root : roots) {
            open.emplace_back(root.get<std::uint64_t>(), 0);
        }
        std::map<std::uint64_t, std::uint64_t> mesh_corners;
        std::uint64_t corners = 0;
        while (!open.empty()) {
            const auto [index, depth] = open.back();
            open.pop_back();
            const std::string where = fmt::format("node {}", index);
            const Json& in = nodes[index];
            Json& out = out_["nodes"][index];
            copy_numbers(in, "matrix", 16, out);
            copy_numbers(in, "translation", 3, out);
            copy_numbers(in, "rotation", 4, out);
            copy_numbers(in, "scale", 3, out);
            if (in.contains("mesh")) {
                const std::uint64_t mesh = in_.number(in, "mesh", where);
                if (!mesh_corners.contains(mesh)) {
                    mesh_corners[mesh] = add_mesh(mesh);
                }
                corners += mesh_corners[mesh];
                if (new_meshes_.contains(mesh)) {
                    out["mesh"] = new_meshes_[mesh];
                }
            }
            if (corners > kMostCorners + kMostInstances * data_.size() || depth > kDeepestGltf) {
                fail(path_, where, "the nodes repeat too much or are nested too deep");
            }
            for (const Json& child : in_.list(in, "children")) {
                out["children"].push_back(child);
                open.emplace_back(child.get<std::uint64_t>(), depth + 1);
            }
        }
    }

    std::string pack() {
        std::string json = out_.dump();
        json.resize((json.size() + 3) / 4 * 4, ' ');
        data_.resize((data_.size() + 3) / 4 * 4, '\0');
        const std::size_t size = 12 + 8 + json.size() + 8 + data_.size();
        if (size > 0xffffffffU) {
            fail(path_, "JSON", "larger than 4 GB");
        }
        std::string bytes;
        bytes.reserve(size);
        for (const std::size_t word :
             {std::size_t{kGlbMagic}, std::size_t{2}, size, json.size(), std::size_t{kGlbJson}}) {
            append_little(bytes, static_cast<std::uint32_t>(word));
        }
        bytes += json;
        append_little(bytes, static_cast<std::uint32_t>(data_.size()));
        append_little(bytes, kGlbBin);
        return bytes += data_;
    }

    const Path& path_;
    std::span<const char> bin_;
    const GltfJson in_;
    Json out_ = {{"nodes", Json::array()},
                 {"meshes", Json::array()},
                 {"accessors", Json::array()},
                 {"bufferViews", Json::array()}};
    std::vector<std::string> buffers_;                      // of the file
    std::uint64_t buffers_size_ = 0;                        // of all together
    std::string data_;                                      // the one buffer of out_
    std::map<std::uint64_t, std::uint64_t> new_accessors_;  // index in the file -> in out_
    std::map<std::uint64_t, std::uint64_t> new_meshes_;
};

}  // namespace

std::string sanitize_gltf(std::span<const char> bytes, const std::filesystem::path& path) {
    if (bytes.empty()) {
        fail(path, "byte 0", "file is empty");
    }
    try {
        return Sanitizer(split_gltf(bytes, path), path).sanitize();
    } catch (const Json::exception&) {
        fail(path, "JSON", "a value has the wrong type");
    }
}

}  // namespace ostraka
