// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/png_file.hpp"

#include "io/io_testing.hpp"
#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

using namespace io_testing;

const std::vector<std::uint16_t> kDepths = {0, 1, 256, 65535, 0x1234, 77};

TEST(PngFile, DepthSurvivesWritingAndReading) {
    const TestFolder folder;
    write_depth_png16(folder / "d.png", 3, 2, kDepths);
    const DepthImage16 image = read_depth_png16(folder / "d.png");
    EXPECT_EQ(image.width, 3);
    EXPECT_EQ(image.height, 2);
    EXPECT_EQ(image.values, kDepths);
}

TEST(PngFile, WritesColorImagesThatAreNoDepth) {
    const TestFolder folder;
    const Image image = {2, 1, {{255, 0, 0}, {1, 2, 3}}};
    write_png(folder / "c.png", image);
    const std::string bytes = load_text(folder / "c.png");
    EXPECT_EQ(bytes, encode_png(image));
    ASSERT_GT(bytes.size(), 33U);
    EXPECT_EQ(bytes.substr(1, 3), "PNG");
    EXPECT_EQ(bytes.substr(16, 10), std::string("\0\0\0\2\0\0\0\1\x08\x02", 10));
    EXPECT_THROW(read_depth_png16(folder / "c.png"), FormatError);
}

TEST(PngFile, WritesMasks) {
    const TestFolder folder;
    const std::vector<std::uint8_t> mask = {0, 255, 255, 0, 0, 255};
    write_gray_png8(folder / "m.png", 2, 3, mask);
    const std::string bytes = load_text(folder / "m.png");
    EXPECT_EQ(bytes, encode_gray_png8(2, 3, mask));
    EXPECT_EQ(bytes.substr(16, 10), std::string("\0\0\0\2\0\0\0\3\x08\0", 10));
    EXPECT_THROW(read_depth_png16(folder / "m.png"), FormatError);
    EXPECT_THROW(encode_gray_png8(3, 3, mask), InvalidInput);
    EXPECT_THROW(write_gray_png8(folder / "none" / "m.png", 2, 3, mask), FileError);
}

TEST(PngFile, LargeDepthImagesSurviveAndArePackedWell) {
    std::vector<std::uint16_t> values(640 * 480);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = static_cast<std::uint16_t>(8000 + i % 640 + (i * 2654435761U >> 20U) % 8);
    }
    const TestFolder folder;
    write_depth_png16(folder / "d.png", 640, 480, values);
    EXPECT_EQ(read_depth_png16(folder / "d.png").values, values);
    EXPECT_LT(std::filesystem::file_size(folder / "d.png"), values.size());  // half
}

TEST(PngFile, TellsTheSizeFromTheHeader) {
    const TestFolder folder;
    write_depth_png16(folder / "d.png", 3, 2, kDepths);
    EXPECT_EQ(read_png_size(folder / "d.png").width, 3);
    EXPECT_EQ(read_png_size(folder / "d.png").height, 2);
    const std::string valid = load_text(folder / "d.png");
    for (std::size_t length = 0; length < 24; ++length) {
        save(folder / "t.png", valid.substr(0, length));
        EXPECT_THROW(read_png_size(folder / "t.png"), FormatError) << length;
    }
    for (const char* width : {"\0\0\0\0", "\xff\0\0\0"}) {
        std::string damaged = valid;
        damaged.replace(16, 4, std::string(width, 4));
        save(folder / "t.png", damaged);
        EXPECT_THROW(read_png_size(folder / "t.png"), FormatError);
    }
    EXPECT_THROW(read_png_size(folder / "none.png"), FileError);
}

TEST(PngFile, RejectsSizesThatDoNotFit) {
    const TestFolder folder;
    EXPECT_THROW(write_depth_png16(folder / "d.png", 3, 3, kDepths), InvalidInput);
    EXPECT_THROW(write_depth_png16(folder / "d.png", -3, -2, kDepths), InvalidInput);
    EXPECT_THROW(write_png(folder / "d.png", {}), InvalidInput);
    EXPECT_FALSE(std::filesystem::exists(folder / "d.png"));
}

TEST(PngFile, DamagedFilesAreRejected) {
    const TestFolder folder;
    write_depth_png16(folder / "d.png", 3, 2, kDepths);
    const std::string valid = load_text(folder / "d.png");
    for (std::size_t length = 0; length < valid.size(); ++length) {
        save(folder / "t.png", valid.substr(0, length));
        EXPECT_THROW(read_depth_png16(folder / "t.png"), FormatError) << length;
    }
    // Every byte is under a checksum, or is one.
    for (std::size_t i = 0; i < valid.size(); ++i) {
        std::string damaged = valid;
        damaged[i] = static_cast<char>(damaged[i] ^ 0x11);
        save(folder / "t.png", damaged);
        EXPECT_THROW(read_depth_png16(folder / "t.png"), FormatError) << i;
    }
}

TEST(PngFile, RejectsAHeaderTooLargeForItsFile) {
    // IHDR of 1,000,000 x 1,000,000 with its right checksum (CRC-32 of "IHDR" and the 13 bytes).
    const TestFolder folder;
    std::string chunk = "IHDR";
    put(chunk, std::uint32_t{1'000'000}, std::endian::big);
    put(chunk, std::uint32_t{1'000'000}, std::endian::big);
    chunk += std::string("\x10\0\0\0\0", 5);
    std::uint32_t crc = 0xffffffffU;
    for (const char c : chunk) {
        crc ^= static_cast<std::uint8_t>(c);
        for (int bit = 0; bit < 8; ++bit) {
            crc = crc >> 1U ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
        }
    }
    write_depth_png16(folder / "d.png", 3, 2, kDepths);
    std::string bytes = load_text(folder / "d.png");
    std::string end;
    put(end, ~crc, std::endian::big);
    bytes.replace(12, 21, chunk + end);
    save(folder / "d.png", bytes);
    try {
        read_depth_png16(folder / "d.png");
        FAIL();
    } catch (const FormatError& error) {
        EXPECT_NE(std::string(error.what()).find("too short for 1000000 x 1000000"),
                  std::string::npos)
            << error.what();
    }
}

}  // namespace
}  // namespace ostraka
