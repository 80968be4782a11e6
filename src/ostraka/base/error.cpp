// SPDX-License-Identifier: Apache-2.0
#include "ostraka/base/error.hpp"

namespace ostraka {

FileError::FileError(const std::filesystem::path& path, const std::string& problem)
    : Error(path.string() + ": " + problem) {}

FormatError::FormatError(const std::filesystem::path& path, const std::string& position,
                         const std::string& problem)
    : Error(path.string() + ": " + position + ": " + problem) {}

Interrupted::Interrupted() : Error("interrupted") {}

}  // namespace ostraka
