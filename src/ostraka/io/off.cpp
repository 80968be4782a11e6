// SPDX-License-Identifier: Apache-2.0
// The Geometry Center. Geomview manual: OFF files.
#include "ostraka/io/off.hpp"

#include <fmt/format.h>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

class OffParser {
  public:
    OffParser(std::span<const char> bytes, const std::filesystem::path& path)
        : lines_(bytes), path_(path) {}

    TriangleMesh parse() {
        parse_counts();
        mesh_.vertices.reserve(vertex_count_);
        mesh_.triangles.reserve(face_count_);
        for (std::uint64_t i = 0; i < vertex_count_; ++i) {
            parse_vertex(i);
        }
        for (std::uint64_t i = 0; i < face_count_; ++i) {
            parse_face(i);
        }
        return std::move(mesh_);
    }

  private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw FormatError(path_, lines_.position(), problem);
    }

    // Splits the next line that isn't empty into words_. False at the end of the file.
    bool next_line() {
        std::string_view line;
        while (lines_.next(line)) {
            split_words(before(line, "#"), words_);
            if (!words_.empty()) {
                return true;
            }
        }
        return false;
    }

    void parse_counts() {
        if (!next_line()) {
            fail("not an OFF file: it is empty");
        }
        const std::size_t end = words_[0].find("OFF");
        if (end == std::string_view::npos ||
            words_[0].substr(0, end).find_first_not_of("STCN") != std::string_view::npos) {
            fail("not an OFF file in three dimensions: it begins with " + quote_word(words_[0]));
        }
        // The counts may follow on the line, and some files lack the blank: "OFF8 12 0".
        words_[0].remove_prefix(end + 3);
        if (words_[0].empty()) {
            words_.erase(words_.begin());
        }
        if (!words_.empty() && words_[0] == "BINARY") {
            fail("binary OFF files are not supported");
        }
        if (words_.empty() && !next_line()) {
            fail("file ends before the counts");
        }
        std::int64_t vertices = 0;
        std::int64_t faces = 0;
        if (words_.size() < 2 || !parse_integer(words_[0], vertices) ||
            !parse_integer(words_[1], faces) || vertices < 0 || faces < 0) {
            fail("expected the numbers of vertices, faces and edges");
        }
        vertex_count_ = static_cast<std::uint64_t>(vertices);
        face_count_ = static_cast<std::uint64_t>(faces);
        // At the least a vertex is the line "0 0 0" and a face the line "0"; the last needs no end.
        const std::uint64_t left = lines_.remaining() + 1;
        if (vertex_count_ > left / 6 || face_count_ > (left - 6 * vertex_count_) / 2 ||
            vertex_count_ >= kNoIndex) {
            fail(fmt::format("file is too short for {} vertices and {} faces", vertex_count_,
                             face_count_));
        }
    }

    void parse_vertex(std::uint64_t i) {
        if (!next_line()) {
            fail(fmt::format("file ends after {} of {} vertices", i, vertex_count_));
        }
        Vec3d vertex;
        for (int axis = 0; axis < 3; ++axis) {
            const auto w = static_cast<std::size_t>(axis);
            if (w >= words_.size() || !parse_number(words_[w], vertex[axis])) {
                fail(fmt::format("vertex {} needs three coordinates", i));
            }
        }
        mesh_.vertices.push_back(vertex.cast<float>());
    }

    void parse_face(std::uint64_t i) {
        if (!next_line()) {
            fail(fmt::format("file ends after {} of {} faces", i, face_count_));
        }
        std::int64_t corners = 0;
        if (!parse_integer(words_[0], corners) || corners < 0 ||
            static_cast<std::uint64_t>(corners) >= words_.size()) {
            fail(fmt::format("face {} states {} corners, the line has {}", i, quote_word(words_[0]),
                             words_.size() - 1));
        }
        polygon_.clear();
        for (std::size_t c = 1; c <= static_cast<std::size_t>(corners); ++c) {
            std::int64_t vertex = 0;
            if (!parse_integer(words_[c], vertex) || vertex < 0 ||
                static_cast<std::uint64_t>(vertex) >= vertex_count_) {
                fail(fmt::format("names vertex {}, but there are {}", quote_word(words_[c]),
                                 vertex_count_));
            }
            polygon_.push_back(static_cast<std::uint32_t>(vertex));
        }
        append_fan(polygon_, mesh_.triangles);
    }

    LineReader lines_;
    const std::filesystem::path& path_;
    std::vector<std::string_view> words_;
    std::vector<std::uint32_t> polygon_;
    std::uint64_t vertex_count_ = 0;
    std::uint64_t face_count_ = 0;
    TriangleMesh mesh_;
};

}  // namespace

TriangleMesh parse_off(std::span<const char> bytes, const std::filesystem::path& path) {
    return OffParser(bytes, path).parse();
}

std::string encode_off(const TriangleMesh& mesh) {
    std::string text = fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.triangles.size());
    for (const Vec3f& vertex : mesh.vertices) {
        for (const float coordinate : vertex) {
            append_number(text, coordinate);
            text += ' ';
        }
        text.back() = '\n';
    }
    for (const Triangle& t : mesh.triangles) {
        fmt::format_to(std::back_inserter(text), "3 {} {} {}\n", t[0], t[1], t[2]);
    }
    return text;
}

}  // namespace ostraka
