// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/ply_header.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "ostraka/base/error.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

struct TypeName {
    const char* name;
    const char* sized_name;
    PlyType type;
    std::size_t size;
};

constexpr std::array<TypeName, 8> kTypes = {{
    {"char", "int8", PlyType::Int8, 1},
    {"uchar", "uint8", PlyType::Uint8, 1},
    {"short", "int16", PlyType::Int16, 2},
    {"ushort", "uint16", PlyType::Uint16, 2},
    {"int", "int32", PlyType::Int32, 4},
    {"uint", "uint32", PlyType::Uint32, 4},
    {"float", "float32", PlyType::Float32, 4},
    {"double", "float64", PlyType::Float64, 8},
}};

class HeaderParser {
  public:
    HeaderParser(std::span<const char> bytes, const std::filesystem::path& path)
        : lines_(bytes), path_(path) {}

    PlyHeader parse() {
        std::string_view line;
        if (!lines_.next(line) || line.substr(0, line.find_last_not_of(' ') + 1) != "ply") {
            throw FormatError(path_, "line 1", "not a PLY file: it doesn't begin with \"ply\"");
        }
        bool has_format = false;
        while (true) {
            if (!lines_.next(line)) {
                fail("file ends before \"end_header\"");
            }
            std::string_view rest = line;
            const std::string_view keyword = next_word(rest);
            if (keyword == "end_header") {
                break;
            }
            if (keyword == "format") {
                parse_format(rest);
                has_format = true;
            } else if (keyword == "element") {
                parse_element(rest);
            } else if (keyword == "property") {
                parse_property(rest);
            } else if (keyword == "comment" || keyword == "obj_info") {
                header_.notes.emplace_back(rest);
            } else if (!keyword.empty()) {
                fail("unknown header line " + quote_word(keyword));
            }
        }
        if (!has_format) {
            fail("header has no \"format\" line");
        }
        header_.size = lines_.offset();
        header_.lines = lines_.number();
        return std::move(header_);
    }

  private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw FormatError(path_, lines_.position(), problem);
    }

    void parse_format(std::string_view rest) {
        const std::string_view name = next_word(rest);
        if (name == "ascii") {
            header_.format = PlyFormat::Ascii;
        } else if (name == "binary_little_endian") {
            header_.format = PlyFormat::BinaryLittleEndian;
        } else if (name == "binary_big_endian") {
            header_.format = PlyFormat::BinaryBigEndian;
        } else {
            fail("unknown format " + quote_word(name));
        }
    }

    void parse_element(std::string_view rest) {
        PlyElement element;
        element.name = next_word(rest);
        const std::string_view word = next_word(rest);
        std::int64_t count = 0;
        if (!parse_integer(word, count) || count < 0) {
            fail(fmt::format("element count {} is not a whole number", quote_word(word)));
        }
        element.count = static_cast<std::uint64_t>(count);
        for (const PlyElement& other : header_.elements) {
            if (other.name == element.name &&
                (element.name == "vertex" || element.name == "face")) {
                fail(fmt::format("second element {}", quote_word(element.name)));
            }
        }
        header_.elements.push_back(std::move(element));
    }

    void parse_property(std::string_view rest) {
        if (header_.elements.empty()) {
            fail("property before the first element");
        }
        PlyProperty property;
        std::string_view type = next_word(rest);
        if (type == "list") {
            property.is_list = true;
            property.count_type = parse_type(next_word(rest));
            if (property.count_type == PlyType::Float32 ||
                property.count_type == PlyType::Float64) {
                fail("the length of a list can't be a fraction");
            }
            type = next_word(rest);
        }
        property.type = parse_type(type);
        property.name = next_word(rest);
        if (property.name.empty()) {
            fail("property without a name");
        }
        header_.elements.back().properties.push_back(std::move(property));
    }

    PlyType parse_type(std::string_view word) const {
        for (const TypeName& type : kTypes) {
            if (word == type.name || word == type.sized_name) {
                return type.type;
            }
        }
        fail("unknown type " + quote_word(word));
    }

    LineReader lines_;
    const std::filesystem::path& path_;
    PlyHeader header_;
};

// The fewest bytes one item can take: a list may be empty, a number of text is a digit and a blank.
std::uint64_t least_size(const PlyElement& element, PlyFormat format) {
    std::uint64_t size = 0;
    for (const PlyProperty& property : element.properties) {
        size += format == PlyFormat::Ascii
                    ? 2
                    : size_of(property.is_list ? property.count_type : property.type);
    }
    return size;
}

void check_counts(const PlyHeader& header, std::size_t file_size,
                  const std::filesystem::path& path) {
    // The last number of a text needs no blank after it.
    const std::size_t ending = header.format == PlyFormat::Ascii ? 1 : 0;
    std::uint64_t left = file_size - header.size + ending;
    for (const PlyElement& element : header.elements) {
        const std::uint64_t least = least_size(element, header.format);
        if (element.count > 0 && least == 0) {
            throw FormatError(
                path, "header",
                fmt::format("element {} has no properties", quote_word(element.name)));
        }
        if (element.count > 0 && element.count > left / least) {
            throw FormatError(
                path, fmt::format("byte {}", header.size),
                fmt::format("file ends too early: {} {} items need at least {} bytes each, {} left",
                            element.count, quote_word(element.name), least, left));
        }
        left -= element.count * least;
    }
}

}  // namespace

std::size_t size_of(PlyType type) {
    return kTypes[static_cast<std::size_t>(type)].size;
}

int PlyElement::find(std::span<const char* const> names) const {
    for (std::size_t i = 0; i < properties.size(); ++i) {
        for (const char* wanted : names) {
            if (properties[i].name == wanted) {
                return static_cast<int>(i);
            }
        }
    }
    return -1;
}

PlyHeader parse_ply_header(std::span<const char> bytes, const std::filesystem::path& path) {
    PlyHeader header = HeaderParser(bytes, path).parse();
    check_counts(header, bytes.size(), path);
    return header;
}

}  // namespace ostraka
