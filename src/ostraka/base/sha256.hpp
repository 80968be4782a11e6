// SPDX-License-Identifier: Apache-2.0
// SHA-256 (FIPS 180-4), for the provenance of files and against damage: the same digest as
// `sha256sum` prints. Uses the processor's SHA instructions where it has them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace ostraka {

/// A digest of bytes that come in pieces.
class Sha256 {
  public:
    void add(std::span<const unsigned char> bytes);
    /// Lower-case hexadecimal, 64 characters. Add nothing afterwards.
    std::string finish();

  private:
    std::array<std::uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                           0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    std::array<unsigned char, 64> block_{};  ///< the first pending_ of them wait for more
    std::size_t pending_ = 0;
    std::uint64_t size_ = 0;
};

/// Lower-case hexadecimal digest of the bytes, 64 characters.
std::string sha256(std::span<const unsigned char> bytes);

/// Digest of a file's content. @throws FileError if it can't be read.
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace ostraka
