// SPDX-License-Identifier: Apache-2.0
// libpng reports errors by longjmp, which must not pass a C++ object with a destructor. So each
// function that calls setjmp holds only plain variables; buffers live with its caller.
#include "ostraka/io/png_file.hpp"

#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <string_view>

#include "ostraka/base/error.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/bytes.hpp"

namespace ostraka {
namespace {

// zlib makes at most 1032 bytes of one; a header that promises more is damaged.
constexpr std::uint64_t kMostExpansion = 1100;
constexpr std::uint32_t kMostPixels = 1'000'000;  // in a row or column, as libpng has it

// What libpng's callbacks work on.
struct Stream {
    std::array<char, 128> problem = {};
    std::string* output = nullptr;
    std::span<const char> input;
    std::size_t offset = 0;
};

void on_error(png_structp png, png_const_charp message) {
    auto& stream = *static_cast<Stream*>(png_get_error_ptr(png));
    std::strncpy(stream.problem.data(), message, stream.problem.size() - 1);
    png_longjmp(png, 1);
}

void on_warning(png_structp /*png*/, png_const_charp /*message*/) {}

void on_write(png_structp png, png_bytep bytes, std::size_t size) {
    bool failed = false;
    try {
        static_cast<Stream*>(png_get_io_ptr(png))
            ->output->append(reinterpret_cast<const char*>(bytes), size);
    } catch (...) {
        failed = true;  // no exception may pass libpng's frames
    }
    if (failed) {
        png_error(png, "out of memory");
    }
}

void on_flush(png_structp /*png*/) {}

void on_read(png_structp png, png_bytep bytes, std::size_t size) {
    auto& stream = *static_cast<Stream*>(png_get_io_ptr(png));
    if (size > stream.input.size() - stream.offset) {
        png_error(png, "file ends too early");
    }
    std::memcpy(bytes, stream.input.data() + stream.offset, size);
    stream.offset += size;
}

struct Writer {
    explicit Writer(Stream& stream)
        : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, &stream, on_error, on_warning)),
          info(png == nullptr ? nullptr : png_create_info_struct(png)) {
        if (info != nullptr) {
            png_set_write_fn(png, &stream, on_write, on_flush);
        }
    }
    ~Writer() { png_destroy_write_struct(&png, &info); }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
    png_structp png;
    png_infop info;
};

struct Reader {
    explicit Reader(Stream& stream)
        : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &stream, on_error, on_warning)),
          info(png == nullptr ? nullptr : png_create_info_struct(png)) {
        if (info != nullptr) {
            png_set_read_fn(png, &stream, on_read);
        }
    }
    ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
    png_structp png;
    png_infop info;
};

struct Shape {
    png_uint_32 width = 0;
    png_uint_32 height = 0;
    int depth = 0;  // bits
    int color_type = 0;
};

// How rows are packed; a negative number leaves the choice to libpng.
struct Packing {
    int level = -1;  // zlib's, 1 to 9
    int filter = -1;
    int strategy = -1;  // zlib's
};

// Measured on VGA depth images with and without noise: level 1 of rows of differences takes 4 to 19
// ms where libpng's own choice takes 16 to 200, for files 3 to 60 % larger; the other filters and
// strategies are slower or their files larger. Masks are runs of equal bytes.
constexpr Packing kFastDepth = {1, PNG_FILTER_SUB};
constexpr Packing kFastMask = {1, PNG_FILTER_NONE, Z_RLE};

bool write_rows(const Writer& writer, const Shape& shape, const Packing& packing, png_bytepp rows) {
    if (setjmp(png_jmpbuf(writer.png)) != 0) {
        return false;
    }
    if (packing.level >= 0) png_set_compression_level(writer.png, packing.level);
    if (packing.strategy >= 0) png_set_compression_strategy(writer.png, packing.strategy);
    if (packing.filter >= 0) png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, packing.filter);
    png_set_IHDR(writer.png, writer.info, shape.width, shape.height, shape.depth, shape.color_type,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(writer.png, writer.info);
    if (shape.depth == 16 && std::endian::native == std::endian::little) {
        png_set_swap(writer.png);
    }
    png_write_image(writer.png, rows);
    png_write_end(writer.png, nullptr);
    return true;
}

bool read_header(const Reader& reader, Shape& shape) {
    if (setjmp(png_jmpbuf(reader.png)) != 0) {
        return false;
    }
    png_read_info(reader.png, reader.info);
    shape.width = png_get_image_width(reader.png, reader.info);
    shape.height = png_get_image_height(reader.png, reader.info);
    shape.depth = png_get_bit_depth(reader.png, reader.info);
    shape.color_type = png_get_color_type(reader.png, reader.info);
    return true;
}

bool read_rows(const Reader& reader, png_bytepp rows) {
    if (setjmp(png_jmpbuf(reader.png)) != 0) {
        return false;
    }
    if (std::endian::native == std::endian::little) {
        png_set_swap(reader.png);
    }
    png_read_image(reader.png, rows);
    png_read_end(reader.png, nullptr);
    return true;
}

std::vector<png_bytep> row_pointers(png_bytep first, std::size_t stride, std::size_t height) {
    std::vector<png_bytep> rows(height);
    for (std::size_t i = 0; i < height; ++i) {
        rows[i] = first + stride * i;
    }
    return rows;
}

Shape checked_shape(int width, int height, int depth, int color_type, std::size_t pixels) {
    if (width <= 0 || height <= 0 ||
        pixels != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
        throw InvalidInput(
            fmt::format("PNG: image of {} x {} with {} pixels", width, height, pixels));
    }
    return {static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), depth, color_type};
}

// libpng's interface lacks const; it doesn't write to the rows of an image it encodes.
std::string encode(const Shape& shape, const Packing& packing, const void* pixels,
                   std::size_t pixel_size) {
    auto* first = static_cast<png_bytep>(const_cast<void*>(pixels));
    std::vector<png_bytep> rows = row_pointers(first, pixel_size * shape.width, shape.height);
    std::string bytes;
    Stream stream;
    stream.output = &bytes;
    const Writer writer(stream);
    if (writer.info == nullptr || !write_rows(writer, shape, packing, rows.data())) {
        throw InvalidInput(fmt::format("PNG: image of {} x {} can't be encoded: {}", shape.width,
                                       shape.height, stream.problem.data()));
    }
    return bytes;
}

}  // namespace

std::string encode_png(const Image& image) {
    const Shape shape =
        checked_shape(image.width, image.height, 8, PNG_COLOR_TYPE_RGB, image.pixels.size());
    return encode(shape, {}, image.pixels.data(), sizeof(Color));
}

void write_png(const std::filesystem::path& path, const Image& image) {
    write_file_atomically(path, encode_png(image));
}

std::string encode_depth_png16(int width, int height, std::span<const std::uint16_t> values) {
    const Shape shape = checked_shape(width, height, 16, PNG_COLOR_TYPE_GRAY, values.size());
    return encode(shape, kFastDepth, values.data(), sizeof(std::uint16_t));
}

std::string encode_gray_png8(int width, int height, std::span<const std::uint8_t> values) {
    const Shape shape = checked_shape(width, height, 8, PNG_COLOR_TYPE_GRAY, values.size());
    return encode(shape, kFastMask, values.data(), sizeof(std::uint8_t));
}

void write_depth_png16(const std::filesystem::path& path, int width, int height,
                       std::span<const std::uint16_t> values) {
    write_file_atomically(path, encode_depth_png16(width, height, values));
}

void write_gray_png8(const std::filesystem::path& path, int width, int height,
                     std::span<const std::uint8_t> values) {
    write_file_atomically(path, encode_gray_png8(width, height, values));
}

PngSize read_png_size(const std::filesystem::path& path) {
    constexpr std::string_view kStart("\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR", 16);
    const FileBytes start = read_file(path, kStart.size() + 8);
    if (start.size < kStart.size() + 8 ||
        std::string_view(start.data.get(), kStart.size()) != kStart) {
        throw FormatError(path, "header", "is not a PNG");
    }
    const auto width = load<std::uint32_t>(start.data.get() + kStart.size(), std::endian::big);
    const auto height = load<std::uint32_t>(start.data.get() + kStart.size() + 4, std::endian::big);
    if (width - 1U >= kMostPixels || height - 1U >= kMostPixels) {
        throw FormatError(path, "header", fmt::format("is of {} x {} pixels", width, height));
    }
    return {static_cast<int>(width), static_cast<int>(height)};
}

DepthImage16 read_depth_png16(const std::filesystem::path& path) {
    const FileBytes file = read_file(path);
    Stream stream;
    stream.input = file.span();
    const Reader reader(stream);
    const auto fail = [&](const std::string& problem) {
        throw FormatError(path, fmt::format("byte {}", stream.offset), problem);
    };
    Shape shape;
    if (reader.info == nullptr || !read_header(reader, shape)) {
        fail(fmt::format("not a usable PNG: {}", stream.problem.data()));
    }
    if (shape.color_type != PNG_COLOR_TYPE_GRAY || shape.depth != 16) {
        fail("not a 16-bit grayscale PNG");
    }
    const std::uint64_t pixels = std::uint64_t{shape.width} * shape.height;
    if (pixels * 2 / kMostExpansion > file.size) {
        fail(fmt::format("file is too short for {} x {} pixels", shape.width, shape.height));
    }
    DepthImage16 image;
    image.width = static_cast<int>(shape.width);
    image.height = static_cast<int>(shape.height);
    image.values.resize(pixels);
    std::vector<png_bytep> rows = row_pointers(reinterpret_cast<png_bytep>(image.values.data()),
                                               sizeof(std::uint16_t) * shape.width, shape.height);
    if (!read_rows(reader, rows.data())) {
        fail(fmt::format("damaged PNG: {}", stream.problem.data()));
    }
    return image;
}

}  // namespace ostraka
