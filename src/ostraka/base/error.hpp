// SPDX-License-Identifier: Apache-2.0
// The exceptions of the library: a caller's mistake, a file that can't be used, a wrong format.
// "No match" is never an exception but a value. The library never prints.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace ostraka {

/// Base of all exceptions that Ostraka throws. what() is one line, fit for a user.
class Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A value handed in is unusable: an empty cloud, a mesh with no area, a setting out of range.
class InvalidInput : public Error {
  public:
    using Error::Error;
};

/// A file can't be opened, read, written or replaced.
class FileError : public Error {
  public:
    FileError(const std::filesystem::path& path, const std::string& problem);
};

/// A file's content is not what its format demands.
class FormatError : public Error {
  public:
    /// @param position  where in the file: "line 12", "byte 340", "vertex 7".
    FormatError(const std::filesystem::path& path, const std::string& position,
                const std::string& problem);
};

/// The caller asked to stop (progress callback returned false).
class Interrupted : public Error {
  public:
    Interrupted();
};

}  // namespace ostraka
