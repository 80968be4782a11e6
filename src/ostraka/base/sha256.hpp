// SPDX-License-Identifier: Apache-2.0
// SHA-256 (FIPS 180-4), for the provenance of files: the same digest as `sha256sum` prints.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace ostraka {

/// Lower-case hexadecimal digest of the bytes, 64 characters.
std::string sha256(std::span<const unsigned char> bytes);

/// Digest of a file's content. @throws FileError if it can't be read.
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace ostraka
