// SPDX-License-Identifier: Apache-2.0
// One process at a time: a lock that the system takes back when its holder dies.
#pragma once

#include <filesystem>

namespace ostraka {

/// Holds a file, made empty if it isn't there, from construction to destruction. Only other
/// FileLocks are kept out. The holder may remove the file: whoever comes next makes a new one.
class FileLock {
  public:
    /// Doesn't wait. @throws FileError if another holds it or it can't be opened for writing.
    explicit FileLock(const std::filesystem::path& path);
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

  private:
    int descriptor_ = -1;
};

}  // namespace ostraka
