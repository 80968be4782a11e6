// SPDX-License-Identifier: Apache-2.0
// Wavefront Technologies. Advanced Visualizer Manual, appendix B1: Object Files.
#include "ostraka/io/obj.hpp"

#include <fmt/format.h>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

class ObjParser {
  public:
    ObjParser(std::span<const char> bytes, const std::filesystem::path& path)
        : lines_(bytes, true), path_(path) {}

    TriangleMesh parse() {
        std::string_view line;
        while (lines_.next(line)) {
            line = before(line, "#");
            const std::string_view keyword = next(line);
            if (keyword == "v") {
                parse_vertex(line);
            } else if (keyword == "f") {
                parse_face(line);
            }
        }
        if (mesh_.vertices.empty()) {
            fail("no vertex: not an OBJ file, or an empty one");
        }
        check_indices(mesh_, path_);
        return std::move(mesh_);
    }

  private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw FormatError(path_, lines_.position(), problem);
    }

    // The next word, without the backslash that joins two lines.
    static std::string_view next(std::string_view& line) {
        std::string_view word = next_word(line);
        while (word.ends_with('\\')) {
            word.remove_suffix(1);
            word = word.empty() ? next_word(line) : word;
        }
        return word;
    }

    void parse_vertex(std::string_view line) {
        Vec3d vertex;
        for (double& coordinate : vertex) {
            const std::string_view word = next(line);
            if (!parse_number(word, coordinate)) {
                fail(quote_word(word) + " is not a coordinate");
            }
        }
        if (mesh_.vertices.size() + 1 >= kNoIndex) {
            fail("too many vertices");
        }
        mesh_.vertices.push_back(vertex.cast<float>());
    }

    void parse_face(std::string_view line) {
        polygon_.clear();
        for (std::string_view word = next(line); !word.empty(); word = next(line)) {
            std::int64_t index = 0;
            if (!parse_integer(before(word, "/"), index) || index == 0) {
                fail(quote_word(word) + " names no vertex (they count from 1)");
            }
            index += index < 0 ? static_cast<std::int64_t>(mesh_.vertices.size()) : -1;
            if (index < 0 || index >= kNoIndex) {
                fail(fmt::format("{} names none of the {} vertices so far", quote_word(word),
                                 mesh_.vertices.size()));
            }
            polygon_.push_back(static_cast<std::uint32_t>(index));
        }
        append_fan(polygon_, mesh_.triangles);
    }

    LineReader lines_;
    const std::filesystem::path& path_;
    std::vector<std::uint32_t> polygon_;
    TriangleMesh mesh_;
};

}  // namespace

TriangleMesh parse_obj(std::span<const char> bytes, const std::filesystem::path& path) {
    return ObjParser(bytes, path).parse();
}

std::string encode_obj(const TriangleMesh& mesh) {
    std::string text;
    for (const Vec3f& vertex : mesh.vertices) {
        text += 'v';
        for (const float coordinate : vertex) {
            text += ' ';
            append_number(text, coordinate);
        }
        text += '\n';
    }
    for (const Triangle& t : mesh.triangles) {
        fmt::format_to(std::back_inserter(text), "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    return text;
}

}  // namespace ostraka
