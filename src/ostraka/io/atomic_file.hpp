// SPDX-License-Identifier: Apache-2.0
// Files that appear whole or not at all: written beside the target, renamed at the end.
#pragma once

#include <filesystem>
#include <string_view>

namespace ostraka {

/// A temporary file beside its target. commit() puts it in the target's place in one step; without
/// it the destructor removes it. So a full disk, an exception or a kill leaves the old target as it
/// was (a kill leaves the temporary, `.NAME.PID-N.tmp`, which the next writer removes).
class AtomicFile {
  public:
    /// Makes the empty temporary.
    /// @throws FileError if it can't be made or the target exists and is not a regular file.
    explicit AtomicFile(const std::filesystem::path& target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// For those who write by path (a database); don't mix with write().
    const std::filesystem::path& temporary() const { return temporary_; }
    /// Appends. @throws FileError.
    void write(std::string_view bytes);
    /// Flushes to the disk and renames to the target. @throws FileError.
    void commit();

  private:
    std::filesystem::path named_;      ///< as the caller wrote it, for messages
    std::filesystem::path target_;     ///< symbolic links followed
    std::filesystem::path temporary_;  ///< empty once committed
    int descriptor_ = -1;
};

/// Writes `bytes` to `path`, replacing what is there. @throws FileError.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace ostraka
