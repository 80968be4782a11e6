// SPDX-License-Identifier: Apache-2.0
// Pictures and 16-bit depth images as PNG files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

struct Image {
    int width = 0;              ///< columns
    int height = 0;             ///< rows
    std::vector<Color> pixels;  ///< width * height, row-major from the top left
};

struct DepthImage16 {
    int width = 0;   ///< columns
    int height = 0;  ///< rows
    std::vector<std::uint16_t>
        values;  ///< width * height, row-major from the top left; often 0 = none
};

struct PngSize {
    int width = 0;   ///< columns
    int height = 0;  ///< rows
};

/// Writes an 8-bit RGB PNG. The file appears whole or not at all.
/// @throws InvalidInput if the sizes don't fit together or are zero, FileError if it can't be
/// written.
void write_png(const std::filesystem::path& path, const Image& image);

/// Writes a 16-bit grayscale PNG, the usual form of a depth image. The unit is up to the caller.
/// @param values  width * height, row-major from the top left.
/// @throws InvalidInput if the sizes don't fit together or are zero, FileError if it can't be
/// written.
void write_depth_png16(const std::filesystem::path& path, int width, int height,
                       std::span<const std::uint16_t> values);

/// Writes an 8-bit grayscale PNG, the usual form of a mask (0 and 255). The rest as above.
void write_gray_png8(const std::filesystem::path& path, int width, int height,
                     std::span<const std::uint8_t> values);

/// The bytes of such a file. @throws InvalidInput as above.
std::string encode_png(const Image& image);
std::string encode_depth_png16(int width, int height, std::span<const std::uint16_t> values);
std::string encode_gray_png8(int width, int height, std::span<const std::uint8_t> values);

/// The size that a PNG's header states; the rest isn't read. @throws FileError, FormatError.
PngSize read_png_size(const std::filesystem::path& path);

/// Reads a 16-bit grayscale PNG.
/// @throws FileError if the file can't be read, FormatError if it is damaged or of another kind.
DepthImage16 read_depth_png16(const std::filesystem::path& path);

}  // namespace ostraka
