// SPDX-License-Identifier: Apache-2.0
// The PCD file format, as the Point Cloud Library's tutorial "The PCD file format" describes it.
#include "ostraka/io/pcd.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/lzf.hpp"
#include "ostraka/io/pcd_header.hpp"
#include "ostraka/io/text.hpp"

namespace ostraka {
namespace {

using Path = std::filesystem::path;

double load_number(const char* bytes, char type, std::size_t size) {
    if (type == 'F') {
        return size == 4 ? static_cast<double>(load<float>(bytes)) : load<double>(bytes);
    }
    const bool is_signed = type == 'I';
    switch (size) {
        case 1:
            return is_signed ? load<std::int8_t>(bytes) : load<std::uint8_t>(bytes);
        case 2:
            return is_signed ? load<std::int16_t>(bytes) : load<std::uint16_t>(bytes);
        case 4:
            return is_signed ? load<std::int32_t>(bytes) : load<std::uint32_t>(bytes);
        default:
            return is_signed ? static_cast<double>(load<std::int64_t>(bytes))
                             : static_cast<double>(load<std::uint64_t>(bytes));
    }
}

// Rows of words.
class TextRows {
  public:
    TextRows(LineReader& lines, const PcdHeader& header, const Path& path)
        : lines_(lines), columns_(header.columns), path_(path) {
        // Every number is at least a digit and a blank or a line's end.
        if (header.points > (lines.remaining() + 1) / 2 / header.columns) {
            throw FormatError(path, lines.position(),
                              fmt::format("file is too short for {} points", header.points));
        }
    }
    void next() {
        std::string_view line;
        do {
            if (!lines_.next(line)) {
                throw FormatError(path_, lines_.position(), "file ends before the last point");
            }
            split_words(line, words_);
        } while (words_.empty());
        if (words_.size() < columns_) {
            throw FormatError(
                path_, lines_.position(),
                fmt::format("{} values where {} are expected", words_.size(), columns_));
        }
    }
    double number(const PcdField& field) const {
        double value = 0.0;
        if (!parse_number(words_[field.column], value)) {
            throw FormatError(path_, lines_.position(),
                              quote_word(words_[field.column]) + " is not a number");
        }
        return value;
    }
    std::uint32_t bits(const PcdField& field) const {
        const double value = number(field);
        if (field.type == 'F') {
            return std::bit_cast<std::uint32_t>(static_cast<float>(value));
        }
        return std::abs(value) <= 0xffffffffU
                   ? static_cast<std::uint32_t>(static_cast<std::int64_t>(value))
                   : 0U;
    }

  private:
    LineReader& lines_;
    std::size_t columns_;
    const Path& path_;
    std::vector<std::string_view> words_;
};

// Rows of bytes; in compressed files each field's values stand together.
class BinaryRows {
  public:
    BinaryRows(const char* bytes, const PcdHeader& header, bool by_field)
        : bytes_(bytes), row_size_(header.row_size), points_(by_field ? header.points : 0) {}

    void next() { ++row_; }
    double number(const PcdField& field) const {
        return load_number(place(field), field.type, field.size);
    }
    std::uint32_t bits(const PcdField& field) const { return load<std::uint32_t>(place(field)); }

  private:
    const char* place(const PcdField& field) const {
        const std::size_t row = row_ - 1;
        return points_ > 0 ? bytes_ + field.offset * points_ + field.size * field.count * row
                           : bytes_ + row_size_ * row + field.offset;
    }

    const char* bytes_;
    std::size_t row_size_;
    std::size_t points_;
    std::size_t row_ = 0;
};

const PcdField* find_field(const PcdHeader& header, std::string_view name, std::string_view other) {
    for (const PcdField& field : header.fields) {
        if ((field.name == name || field.name == other) && field.count > 0) {
            return &field;
        }
    }
    return nullptr;
}

struct Fields {
    std::array<const PcdField*, 3> position;
    std::array<const PcdField*, 3> normal;
    const PcdField* color;
    bool has_normal = false;
};

Fields find_fields(const PcdHeader& header, const LineReader& lines, const Path& path) {
    Fields fields = {
        {find_field(header, "x", "x"), find_field(header, "y", "y"), find_field(header, "z", "z")},
        {find_field(header, "normal_x", "nx"), find_field(header, "normal_y", "ny"),
         find_field(header, "normal_z", "nz")},
        find_field(header, "rgb", "rgba")};
    for (const PcdField* field : fields.position) {
        if (field == nullptr) {
            throw FormatError(path, lines.position(), "no fields x, y, z");
        }
    }
    fields.has_normal =
        fields.normal[0] != nullptr && fields.normal[1] != nullptr && fields.normal[2] != nullptr;
    if (fields.color != nullptr && fields.color->size != 4) {
        fields.color = nullptr;
    }
    return fields;
}

template <class Rows>
Vec3f read_vector(const Rows& rows, const std::array<const PcdField*, 3>& fields) {
    return Vec3d(rows.number(*fields[0]), rows.number(*fields[1]), rows.number(*fields[2]))
        .cast<float>();
}

template <class Rows>
void read_rows(Rows rows, const PcdHeader& header, const Fields& fields, PointCloud& cloud) {
    cloud.points.reserve(header.points);
    cloud.normals.reserve(fields.has_normal ? header.points : 0);
    cloud.colors.reserve(fields.color != nullptr ? header.points : 0);
    for (std::uint64_t i = 0; i < header.points; ++i) {
        rows.next();
        cloud.points.push_back(read_vector(rows, fields.position));
        if (fields.has_normal) {
            cloud.normals.push_back(read_vector(rows, fields.normal));
        }
        if (fields.color != nullptr) {
            const std::uint32_t bits = rows.bits(*fields.color);
            cloud.colors.push_back({static_cast<std::uint8_t>(bits >> 16U),
                                    static_cast<std::uint8_t>(bits >> 8U),
                                    static_cast<std::uint8_t>(bits)});
        }
    }
}

[[noreturn]] void fail_at_byte(const Path& path, std::size_t byte, const std::string& problem) {
    throw FormatError(path, fmt::format("byte {}", byte), problem);
}

// The rows of a binary_compressed body: two sizes, then LZF.
std::string decompress_body(std::span<const char> bytes, std::size_t offset,
                            const PcdHeader& header, const Path& path) {
    std::span<const char> body = bytes.subspan(offset);
    if (body.size() < 8) {
        fail_at_byte(path, offset, "file ends before the compressed data");
    }
    const std::uint64_t compressed = load<std::uint32_t>(body.data());
    const std::uint64_t full = load<std::uint32_t>(body.data() + 4);
    body = body.subspan(8);
    if (compressed > body.size()) {
        fail_at_byte(
            path, offset,
            fmt::format("file ends after {} of {} compressed bytes", body.size(), compressed));
    }
    // Division keeps a product of two header counts from overflowing.
    const bool fits = full % header.row_size == 0 && full / header.row_size == header.points;
    if (!fits || full / kLzfMostExpansion > compressed) {
        fail_at_byte(path, offset,
                     fmt::format("{} uncompressed bytes don't fit {} points of {}", full,
                                 header.points, header.row_size));
    }
    std::string rows(full, '\0');
    if (!decompress_lzf(body.first(compressed), rows)) {
        fail_at_byte(path, offset, "compressed data is damaged");
    }
    return rows;
}

}  // namespace

CloudFile parse_pcd(std::span<const char> bytes, const std::filesystem::path& path) {
    LineReader lines(bytes);
    const PcdHeader header = parse_pcd_header(lines, path);
    const Fields fields = find_fields(header, lines, path);
    CloudFile file;
    if (header.data == "ascii") {
        read_rows(TextRows(lines, header, path), header, fields, file.cloud);
    } else if (header.data == "binary") {
        if (header.points > lines.remaining() / header.row_size) {
            fail_at_byte(path, lines.offset(),
                         fmt::format("file ends after {} of {} points",
                                     lines.remaining() / header.row_size, header.points));
        }
        read_rows(BinaryRows(bytes.data() + lines.offset(), header, false), header, fields,
                  file.cloud);
    } else {
        const std::string rows = decompress_body(bytes, lines.offset(), header, path);
        read_rows(BinaryRows(rows.data(), header, true), header, fields, file.cloud);
    }
    constexpr std::uint64_t kMostInt = std::numeric_limits<int>::max();
    if (header.height > 1 && header.points > 0 && header.width <= kMostInt &&
        header.height <= kMostInt) {
        file.cloud.width = static_cast<int>(header.width);
        file.cloud.height = static_cast<int>(header.height);
    }
    file.cloud.viewpoint = header.viewpoint;
    file.has_viewpoint = !header.viewpoint.isZero(0.0F);
    return file;
}

std::string encode_pcd(const PointCloud& cloud) {
    const bool normals = !cloud.normals.empty();
    const bool colors = !cloud.colors.empty();
    std::string viewpoint;
    for (const float coordinate : cloud.viewpoint) {
        append_number(viewpoint, coordinate);
        viewpoint += ' ';
    }
    const auto line = [&](const char* xyz, const char* normal, const char* color) {
        return fmt::format("{}{}{}\n", xyz, normals ? normal : "", colors ? color : "");
    };
    std::string bytes = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n";
    bytes += line("FIELDS x y z", " normal_x normal_y normal_z", " rgb");
    bytes += line("SIZE 4 4 4", " 4 4 4", " 4");
    bytes += line("TYPE F F F", " F F F", " F");
    bytes += line("COUNT 1 1 1", " 1 1 1", " 1");
    const std::size_t width =
        cloud.organized() ? static_cast<std::size_t>(cloud.width) : cloud.size();
    bytes += fmt::format("WIDTH {}\nHEIGHT {}\nVIEWPOINT {}1 0 0 0\nPOINTS {}\nDATA binary\n",
                         width, cloud.organized() ? cloud.height : 1, viewpoint, cloud.size());
    constexpr std::size_t kMostPointSize = 28;
    bytes.reserve(bytes.size() + kMostPointSize * cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        append_little(bytes, cloud.points[i]);
        if (normals) {
            append_little(bytes, cloud.normals[i]);
        }
        if (colors) {
            const auto [red, green, blue] = cloud.colors[i];
            append_little(bytes, static_cast<std::uint32_t>(red << 16 | green << 8 | blue));
        }
    }
    return bytes;
}

}  // namespace ostraka
