// SPDX-License-Identifier: Apache-2.0
#include "ostraka/base/sha256.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

std::string digest(const std::string& text) {
    const std::vector<unsigned char> bytes(text.begin(), text.end());
    return sha256(bytes);
}

// The examples that NIST publishes with FIPS 180-4.
TEST(Sha256, MatchesTheStandardsExamples) {
    EXPECT_EQ(digest(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(digest("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(digest("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    EXPECT_EQ(digest(std::string(1'000'000, 'a')),
              "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// Where padding crosses into another block a mistake would repeat a digest or lose bytes.
TEST(Sha256, DistinguishesLengthsAroundBlocks) {
    std::set<std::string> digests;
    for (std::size_t length = 0; length <= 200; ++length) {
        digests.insert(digest(std::string(length, '\0')));
    }
    EXPECT_EQ(digests.size(), 201U);
}

TEST(Sha256, PiecesGiveTheDigestOfTheWhole) {
    std::vector<unsigned char> bytes(1000);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<unsigned char>(7 * i);
    for (const std::size_t piece : {1U, 3U, 63U, 64U, 65U, 200U, 999U}) {
        Sha256 digest;
        for (std::size_t i = 0; i < bytes.size(); i += piece) {
            digest.add(std::span(bytes).subspan(i, std::min(piece, bytes.size() - i)));
        }
        EXPECT_EQ(digest.finish(), sha256(bytes)) << piece;
    }
}

class Sha256OfFile : public testing::Test {
  protected:
    Sha256OfFile() : folder_(std::filesystem::path(testing::TempDir()) / "ostraka_sha256_test") {
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    ~Sha256OfFile() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path write(const std::string& content) const {
        const std::filesystem::path path = folder_ / "file";
        std::ofstream(path, std::ios::binary) << content;
        return path;
    }
    std::filesystem::path folder_;
};

TEST_F(Sha256OfFile, IsTheDigestOfItsBytes) {
    EXPECT_EQ(sha256_of_file(write("")), digest(""));
    EXPECT_EQ(sha256_of_file(write(std::string("a\r\n\0\xff\x1a z", 8))),
              digest(std::string("a\r\n\0\xff\x1a z", 8)));
    std::string large(3'000'001, 'x');
    for (std::size_t i = 0; i < large.size(); ++i) large[i] = static_cast<char>(i % 251);
    EXPECT_EQ(sha256_of_file(write(large)), digest(large));
}

TEST_F(Sha256OfFile, NamesAFileThatCannotBeRead) {
    try {
        sha256_of_file(folder_ / "missing.ply");
        FAIL() << "no exception";
    } catch (const FileError& error) {
        EXPECT_NE(std::string(error.what()).find("missing.ply"), std::string::npos);
    }
    EXPECT_THROW(sha256_of_file(folder_), FileError);
}

}  // namespace
}  // namespace ostraka
