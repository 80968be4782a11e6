// SPDX-License-Identifier: Apache-2.0
// 3D Systems. StereoLithography Interface Specification. 1988.
#include "ostraka/io/stl.hpp"

#include <fmt/format.h>

#include <array>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

using Path = std::filesystem::path;

constexpr std::size_t kHeaderSize = 84;    // 80 bytes of text and the count
constexpr std::size_t kTriangleSize = 50;  // normal, three corners, 2 bytes of attributes
constexpr std::size_t kNormalSize = 12;
constexpr std::size_t kMostTriangles = kNoIndex / 3;

std::size_t stated_triangles(std::span<const char> bytes) {
    return load<std::uint32_t>(bytes.data() + kHeaderSize - 4);
}

// Exporters write "solid" into binary files too, so the size decides first, then whether there is a
// zero byte, which text never holds and a binary file's count or coordinates nearly always do.
bool is_text(std::span<const char> bytes) {
    const std::string_view text(bytes.data(), bytes.size());
    if (bytes.size() >= kHeaderSize &&
        bytes.size() == kHeaderSize + kTriangleSize * stated_triangles(bytes)) {
        return false;
    }
    constexpr std::size_t kLooked = 1024;
    std::string_view start = text.substr(0, kLooked);
    const bool zeros = start.find('\0') != std::string_view::npos;
    const std::string_view word = next_word(start);
    return !zeros && (equals_ignoring_case(word, "solid") || equals_ignoring_case(word, "facet"));
}

TriangleMesh parse_binary(std::span<const char> bytes, const Path& path) {
    if (bytes.size() < kHeaderSize) {
        throw FormatError(path, fmt::format("byte {}", bytes.size()),
                          "file ends inside the header of a binary STL");
    }
    const std::size_t count = stated_triangles(bytes);
    const std::size_t present = (bytes.size() - kHeaderSize) / kTriangleSize;
    if (count > present) {
        throw FormatError(path, fmt::format("byte {}", kHeaderSize),
                          fmt::format("file ends after {} of {} triangles", present, count));
    }
    if (count > kMostTriangles) {
        throw FormatError(path, "header", fmt::format("{} triangles are too many", count));
    }
    TriangleMesh mesh;
    mesh.vertices.reserve(3 * count);
    mesh.triangles.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const char* corner = bytes.data() + kHeaderSize + kTriangleSize * i + kNormalSize;
        for (int c = 0; c < 3; ++c, corner += 12) {
            mesh.vertices.emplace_back(load<float>(corner), load<float>(corner + 4),
                                       load<float>(corner + 8));
        }
        const auto first = static_cast<std::uint32_t>(3 * i);
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

class TextParser {
  public:
    TextParser(std::span<const char> bytes, const Path& path) : lines_(bytes), path_(path) {}

    TriangleMesh parse() {
        bool open = false;  // inside a solid
        std::string_view line;
        while (lines_.next(line)) {
            line_ = line;
            const std::string_view word = next_word(line_);
            if (equals_ignoring_case(word, "solid")) {
                open = true;
                line_ = {};  // the rest is its name
            } else if (equals_ignoring_case(word, "endsolid")) {
                open = false;
                line_ = {};
            } else if (equals_ignoring_case(word, "facet")) {
                parse_facet();
            } else if (!word.empty()) {
                fail(quote_word(word) + " where \"facet\" or \"endsolid\" is expected");
            }
        }
        if (open) {
            fail(fmt::format("file ends after {} triangles without \"endsolid\"",
                             mesh_.triangles.size()));
        }
        return std::move(mesh_);
    }

  private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw FormatError(path_, lines_.position(), problem);
    }

    std::string_view next() {
        std::string_view word = next_word(line_);
        while (word.empty()) {
            if (!lines_.next(line_)) {
                fail("file ends inside a facet");
            }
            word = next_word(line_);
        }
        return word;
    }

    void expect(std::string_view lower) {
        const std::string_view word = next();
        if (!equals_ignoring_case(word, lower)) {
            fail(fmt::format("{} where \"{}\" is expected", quote_word(word), lower));
        }
    }

    Vec3f read_vector() {
        Vec3d vector;
        for (double& coordinate : vector) {
            const std::string_view word = next();
            if (!parse_number(word, coordinate)) {
                fail(quote_word(word) + " is not a number");
            }
        }
        return vector.cast<float>();
    }

    void parse_facet() {
        if (mesh_.triangles.size() >= kMostTriangles) {
            fail("too many triangles");
        }
        expect("normal");
        read_vector();
        expect("outer");
        expect("loop");
        const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
        for (int corner = 0; corner < 3; ++corner) {
            expect("vertex");
            mesh_.vertices.push_back(read_vector());
        }
        expect("endloop");
        expect("endfacet");
        mesh_.triangles.push_back({first, first + 1, first + 2});
        if (const std::string_view rest = next_word(line_); !rest.empty()) {
            fail(quote_word(rest) + " after \"endfacet\"");
        }
    }

    LineReader lines_;
    const Path& path_;
    std::string_view line_;
    TriangleMesh mesh_;
};

}  // namespace

TriangleMesh parse_stl(std::span<const char> bytes, const std::filesystem::path& path) {
    return is_text(bytes) ? TextParser(bytes, path).parse() : parse_binary(bytes, path);
}

std::string encode_stl(const TriangleMesh& mesh) {
    std::string bytes = "binary STL";  // must not begin with "solid"
    bytes.resize(kHeaderSize - 4, ' ');
    bytes.reserve(kHeaderSize + kTriangleSize * mesh.triangles.size());
    append_little(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const Triangle& triangle : mesh.triangles) {
        const Vec3d area = area_vector(mesh, triangle);
        append_little(bytes, Vec3f(area.stableNormalized().cast<float>()));
        for (const std::uint32_t vertex : triangle) {
            append_little(bytes, mesh.vertices[vertex]);
        }
        append_little(bytes, std::uint16_t{0});
    }
    return bytes;
}

}  // namespace ostraka
